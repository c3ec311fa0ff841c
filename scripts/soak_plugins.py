"""The plugins that scripts/soak saves, those that work and mistakes of each kind, and who saves them."""

import re
import shutil
import time

BRDF_MANIFEST = """kind = "brdf"
name = "Mine"
about = "A soak's own."
[params.gain]
type = "float"
default = 0.8
range = [0.0, 1.0]
about = "How much it reflects."
[params.power]
type = "float"
default = 20.0
range = [1.0, 200.0]
scale = "log"
about = "How narrow its lobe is."
[params.steps]
type = "int"
default = 3
range = [1, 16]
about = "Lobes that are added up."
[params.tint]
type = "color"
default = [0.9, 0.9, 0.9]
about = "Its colour."
"""
INTEGRATOR_MANIFEST = """kind = "integrator"
name = "Mine too"
about = "A soak's own."
[params.share]
type = "float"
default = 0.5
range = [0.0, 0.95]
about = "Share of the samples that are drawn from the BRDF."
"""
EVAL = "fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {\n"
ESTIMATE = "fn estimate(q: Settings, hit: Hit, s: ptr<function, Sampler>) -> vec3f {\n"


def triple(colour):
    return "vec3f(" + ", ".join(f"{channel:.6f}" for channel in colour) + ")"


def right_brdf(rng, colour):
    """One that works, in this colour."""
    base = f"p.gain * p.tint * {triple(colour)} * INV_PI"
    plain = EVAL + f"    return {base};\n}}\n"
    lobe = EVAL + (
        "    let h = normalize(wo + wi);\n    var f = vec3f(0.0);\n"
        "    for (var i = 0; i < p.steps; i++) {\n        f += vec3f(pow(h.z, p.power * f32(i + 1)) * 0.05);\n    }\n"
        f"    return f + {base};\n}}\n"
    )
    # A diffuse one with a sampler of its own, by Malley's disk.
    sampled = plain + (
        "fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {\n    let r = sqrt(u.x);\n"
        "    return vec3f(r * cos(TWO_PI * u.y), r * sin(TWO_PI * u.y), sqrt(1.0 - u.x));\n}\n"
        "fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {\n    return wi.z * INV_PI;\n}\n"
    )
    return rng.choice([plain, lobe, sampled])


def right_integrator(rng, colour):
    """One that works, times this colour."""
    times = triple(colour)
    mixed = ESTIMATE + (
        "    let pick = next_1d(s);\n    let u = next_3d(s);\n"
        "    var wi = direction_below_pole(u.x, TWO_PI * u.y);\n"
        "    if pick < q.share {\n        wi = brdf_sample(hit.wo, u).wi;\n    }\n"
        "    let value = brdf_cos(hit.wo, wi);\n    if all(value == vec3f(0.0)) {\n        return value;\n    }\n"
        "    let density = q.share * brdf_pdf(hit.wo, wi) + (1.0 - q.share) * INV_TWO_PI;\n"
        f"    return {times} * value * env_radiance(to_world(hit, wi)) / density;\n}}\n"
    )
    by_light = ESTIMATE + (
        "    let light = env_sample(next_2d_bits(s));\n    if light.pdf <= 0.0 {\n        return vec3f(0.0);\n    }\n"
        f"    return {times} * brdf_cos(hit.wo, to_local(hit, light.dir)) * light.radiance / light.pdf;\n}}\n"
    )
    by_sum = (
        "fn term(q: Settings, hit: Hit, k: u32, sum: ptr<function, Quadrature>) -> vec3f {\n"
        "    let cell = env_cell(k);\n    (*sum).evaluations += 1u;\n"
        "    let light = env_cell_light(cell, vec2f(0.5)).radiance * cell.solid_angle;\n"
        f"    return {times} * brdf_cos(hit.wo, to_local(hit, cell.dir)) * light;\n}}\n"
    )
    return rng.choice([mixed, by_light, by_sum])


def flat_brdf(colour):
    return EVAL + f"    return {triple(colour)} * INV_PI;\n}}\n"


def flat_integrator(colour):
    """The BRDF's value straight up and no light: the object becomes a disk of one colour."""
    return ESTIMATE + f"    return {triple(colour)} * PI * brdf_cos(hit.wo, vec3f(0.0, 0.0, 1.0));\n}}\n"


def wrong(head, parameter):
    """Mistakes of each kind, in a file that begins like this: a name, and how the text comes about."""
    doubling = "".join(f"const d{n} = array(d{n - 1}, d{n - 1});\n" for n in range(1, 25))
    return {
        "syntax": lambda rng: head + "    return vec3f(0.5 * INV_PI;\n}\n",
        "unknown name": lambda rng: head + f"    return vec3f({parameter}_) * INV_PI;\n}}\n",
        "wrong type": lambda rng: head + "    return 0.5;\n}\n",
        "endless": lambda rng: head
        + rng.choice(
            [
                f"    var x = {parameter};\n    loop {{\n        x = fract(x * 1.7 + 0.1);\n"
                "        if x > 2.0 {\n            break;\n        }\n    }\n    return vec3f(x);\n}\n",
                f"    var n = 0u;\n    while n < 4000000000u {{\n        n += select(0u, 1u, {parameter} >= 0.0);\n"
                "    }\n    return vec3f(f32(n));\n}\n",
            ]
        ),
        "huge constant": lambda rng: rng.choice(
            [
                "const d0 = 1.0;\n" + doubling + head + "    return vec3f(d24[0]);\n}\n",
                head + "    return vec3f(" + " + ".join(["0.001"] * rng.randrange(16000, 40000)) + ");\n}\n",
                head + "    return vec3f(" + "(" * 3000 + "1.0" + ")" * 3000 + ");\n}\n",
            ]
        ),
        "recursion": lambda rng: "fn again(x: f32) -> f32 {\n    return again(x);\n}\n"
        + head
        + f"    return vec3f(again({parameter}));\n}}\n",
        "empty": lambda rng: "",
        "no text": lambda rng: bytes(rng.randrange(256) for _ in range(400)),
    }


WRONG_BRDF = wrong(EVAL, "p.gain")
WRONG_INTEGRATOR = wrong(ESTIMATE, "q.share")


class Author:
    """Who saves them, at random, in a way of theirs; `pause` waits for some seconds."""

    def __init__(self, rng, work, pause):
        self.rng, self.pause = rng, pause
        self.brdf, self.integrator = work / "mine", work / "minetoo"
        self.actions = {
            self.save_right: 6, self.save_wrong: 8, self.save_odd: 2, self.tear: 2, self.take_away: 2,
            self.change_manifest: 3,
        }  # fmt: skip

    def begin(self):
        """Both work."""
        self.write(self.source(self.brdf), right_brdf(self.rng, (0.5, 0.5, 0.5)))
        self.write(self.source(self.integrator), right_integrator(self.rng, (1.0, 1.0, 1.0)))
        self.save_manifests()

    def save_manifests(self):
        """The manifests that both began with."""
        self.save(self.brdf / "plugin.toml", BRDF_MANIFEST)
        self.save(self.integrator / "plugin.toml", INTEGRATOR_MANIFEST)

    def save_flat(self, by_brdf, by_integrator):
        """Both, in an order by chance: together they make one colour."""
        both = [
            (self.source(self.brdf), flat_brdf(by_brdf)),
            (self.source(self.integrator), flat_integrator(by_integrator)),
        ]
        self.rng.shuffle(both)
        for path, text in both:
            self.save(path, text)

    @staticmethod
    def source(folder):
        return folder / f"{folder.name}.wgsl"

    def write(self, path, text, way="plain"):
        data = text if isinstance(text, bytes) else text.encode()
        path.parent.mkdir(parents=True, exist_ok=True)
        if way == "plain":
            path.write_bytes(data)
        elif way == "rename":
            other = path.with_name(path.name + "~")
            other.write_bytes(data)
            other.replace(path)
        else:
            with path.open("wb") as file:
                file.write(data[: len(data) // 2])
                file.flush()
                time.sleep(self.rng.uniform(0.005, 0.1))
                file.write(data[len(data) // 2 :])

    def save(self, path, text):
        self.write(path, text, self.rng.choice(["plain", "rename", "halves"]))

    def either(self):
        """One of the two plugins: its folder, a version that works, and those that do not."""
        colour = [self.rng.uniform(0.1, 0.9) for _ in range(3)]
        if self.rng.random() < 0.6:
            return self.brdf, right_brdf(self.rng, colour), WRONG_BRDF
        return self.integrator, right_integrator(self.rng, colour), WRONG_INTEGRATOR

    def save_right(self):
        folder, right, _ = self.either()
        self.save(self.source(folder), right)
        return "right"

    def save_wrong(self):
        """A mistake; says of which kind."""
        folder, _, wrongs = self.either()
        kind = self.rng.choice(list(wrongs))
        self.save(self.source(folder), wrongs[kind](self.rng))
        return kind

    def save_odd(self):
        """One that works, and should not."""
        folder, _, _ = self.either()
        head, parameter = (EVAL, "p.gain") if folder == self.brdf else (ESTIMATE, "q.share")
        kind, value = self.rng.choice(
            [
                ("NaN", f"sqrt(-1.0 - {parameter})"),
                ("Inf", f"(1.0 + {parameter}) / ({parameter} - {parameter})"),
                ("negative", f"-1.0 - {parameter}"),
                ("long sum", " + ".join(["0.001"] * self.rng.randrange(500, 5000))),
            ]
        )
        self.save(self.source(folder), head + f"    return vec3f({value});\n}}\n")
        return kind

    def tear(self):
        folder, right, _ = self.either()
        self.write(self.source(folder), right[: self.rng.randrange(len(right))])
        return "torn"

    def take_away(self):
        """The file, or the whole folder, is gone for a moment, and is another one afterwards."""
        folder, right, _ = self.either()
        pause = self.rng.uniform(0.01, 1.5)
        if self.rng.random() < 0.5:
            self.source(folder).unlink(missing_ok=True)
            self.pause(pause)
            self.write(self.source(folder), right)
            return "file gone and back"
        manifest = (folder / "plugin.toml").read_bytes()
        away = folder.with_name(folder.name + ".away")
        folder.rename(away)
        self.pause(pause)
        if self.rng.random() < 0.5:
            away.rename(folder)
        else:
            shutil.rmtree(away)
            self.write(folder / "plugin.toml", manifest)
        self.write(self.source(folder), right)
        return "folder gone and back"

    def change_manifest(self):
        folder, right, _ = self.either()
        text = BRDF_MANIFEST if folder == self.brdf else INTEGRATOR_MANIFEST
        number = self.rng.randrange(100)
        kind, text = self.rng.choice(
            [
                ("a new parameter", text + f'[params.n{number}]\ntype = "bool"\ndefault = true\nabout = "New."\n'),
                ("another range", re.sub(r"range = \[0\.0, [\d.]+\]", "range = [0.0, 0.85]", text)),
                ("another default", re.sub("default = 0.[58]\n", f"default = 0.{number % 8}5\n", text)),
                ("manifest broken", text.replace("type", "typ", 1)),
                ("manifest torn", text[: self.rng.randrange(len(text))]),
                ("manifest empty", ""),
            ]
        )
        self.save(folder / "plugin.toml", text)
        if self.rng.random() < 0.5:
            self.save(self.source(folder), right)
        return kind
