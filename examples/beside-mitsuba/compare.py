#!/usr/bin/env python3
"""Error against seconds, side by side in one run: this program's integrators and Mitsuba 3's `direct`.

    python3 -m venv venv && venv/bin/pip install mitsuba==3.9.1 numpy
    venv/bin/python examples/beside-mitsuba/compare.py [--brdf target/release/brdf] [--markdown FILE]

Mitsuba 3.9 wants LLVM 17 or later: on Debian 12 `apt-get install libllvm19`, and
DRJIT_LIBLLVM_PATH=/usr/lib/x86_64-linux-gnu/libLLVM.so.19.1.

The same sphere, the same map, directions through the same pixel centres, the same cores. Each program is held against
its own converged reference, since each reads the map between texel centres in its own way; errors are means over three
seeds, from which that of the reference is taken off. Times are of rendering: no loading, no compiling, no reading back on
our side; on Mitsuba's a second call of the same kernel, its film included.

What differs, and is what it is about: ours casts rays once and computes covered pixels alone (57 % of them here), without
shadow rays, which a single convex object does not need. Mitsuba casts a ray for each sample of each pixel, and shadow rays.
"""

import argparse
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np

try:
    import mitsuba as mi
except ImportError:
    sys.exit("mitsuba: it is not installed; pip install mitsuba numpy")

SEEDS = 3
SAMPLERS = ["independent", "stratified", "multijitter", "orthogonal", "ldsampler"]
INTEGRATORS = ["brdf-is", "env-is", "mis-balance", "mis-compensated", "product"]
SCENES = [
    # name, plugin, its parameters, Mitsuba's BSDF, map
    (f"{name} under {light}", plugin, sets, bsdf, light)
    for name, plugin, sets, bsdf in [
        (
            "lambert",
            "lambert",
            ["albedo=0.5,0.5,0.5"],
            {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.5}},
        ),
        *[
            (
                f"ggx {alpha}",
                "ggx",
                [f"alpha_x={alpha}", f"alpha_y={alpha}", "f0=1,1,1"],
                {"type": "roughconductor", "material": "none", "distribution": "ggx", "alpha": alpha},
            )
            for alpha in [0.1, 0.02]
        ],
    ]
    for light in ["studio", "sky-with-sun"]
]


# ----------------------------------------------------------------------------------------------- this program


def ours(options, scene, device):
    """Curves by integrator: lists of (seconds, relMSE), means over seeds; the device's name."""
    runs = [ours_once(options, scene, device, seed) for seed in range(SEEDS)]
    names = set.intersection(*(set(curves) for curves, _, _ in runs))
    curves = {}
    for name in names:
        length = min(len(curves[name]) for curves, _, _ in runs)
        steps = [[curves[name][k] for curves, _, _ in runs] for k in range(length)]
        curves[name] = [
            (
                statistics.median(seconds for seconds, _ in step),
                max(statistics.fmean(error for _, error in step) - runs[0][1], 1e-12),
            )
            for step in steps
        ]
    return curves, runs[0][1], runs[0][2]


def ours_once(options, scene, device, seed):
    _, plugin, sets, _, light = scene
    with tempfile.TemporaryDirectory() as folder:
        report = os.path.join(folder, "report.json")
        command = [options.brdf, "bench", plugin, "--maps", light, "--ibl-width", str(options.width)]
        command += ["--integrators", ",".join(INTEGRATORS), "--time", str(2 * options.time)]
        command += ["--resolution", str(options.resolution), "--replicates", str(options.replicates)]
        command += ["--repeats", "1", "--seed", str(seed), "--device", device, "--json", report]
        for assignment in sets:
            command += ["--set", assignment]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{' '.join(command)}: {done.stderr.strip()}")
        with open(report) as file:
            found = json.load(file)
    floor = found["cases"][0]["reference_relmse"]
    curves = {
        cell["integrator"]: [(s["seconds"]["median"], s["errors"]["relmse"]) for s in cell["steps"]]
        for cell in found["cells"]
        if not cell["problem"] and cell["steps"]
    }
    return curves, floor, found["devices"][0]["name"]


# ---------------------------------------------------------------------------------------------------- Mitsuba


def define_centres():
    """A pinhole whose rays go through pixel centres, wherever the sampler puts them in the pixel."""

    class Centres(mi.Sensor):
        def __init__(self, props):
            super().__init__(props)
            self.side = props["side"]
            self.distance = props["distance"]
            self.tangent = math.tan(math.radians(props["fov"] / 2))

        def ray(self, position):
            cell = mi.Point2f(mi.Vector2i(position * self.side))
            x = ((cell.x + 0.5) / self.side * 2 - 1) * self.tangent
            y = (1 - (cell.y + 0.5) / self.side * 2) * self.tangent
            way = mi.Vector3f(x, y, -1)
            length = way.x * way.x + way.y * way.y + 1
            ray = mi.Ray3f(mi.Point3f(0, 0, self.distance), way / mi.Float(length) ** 0.5)
            return ray

        def sample_ray(self, time, wavelength, position, aperture, active=True):
            return self.ray(position), mi.Color3f(1)

        def sample_ray_differential(self, time, wavelength, position, aperture, active=True):
            return mi.RayDifferential3f(self.ray(position)), mi.Color3f(1)

        def bbox(self):
            return mi.BoundingBox3f(mi.Point3f(0, 0, self.distance))

    mi.register_sensor("centres", lambda props: Centres(props))


def theirs_scene(bsdf, light):
    return mi.load_dict(
        {
            "type": "scene",
            "light": {"type": "envmap", "filename": light},
            "object": {"type": "sphere", "bsdf": bsdf},
        }
    )


def theirs_sensor(options, sampler, centres):
    film = {
        "type": "hdrfilm",
        "width": options.resolution,
        "height": options.resolution,
        "rfilter": {"type": "box"},
        "pixel_format": "rgba",
        "component_format": "float32",
    }
    common = {"film": film, "sampler": {"type": sampler, "sample_count": 16}}
    if centres:
        return mi.load_dict(
            {"type": "centres", "side": options.resolution, "distance": 4.5, "fov": 30.0, **common}
        )
    look = mi.ScalarTransform4f().look_at([0, 0, 4.5], [0, 0, 0], [0, 1, 0])
    return mi.load_dict({"type": "perspective", "fov": 30, "to_world": look, **common})


def picture(scene, sensor, integrator, spp, seed):
    start = time.perf_counter()
    image = np.array(mi.render(scene, sensor=sensor, integrator=integrator, spp=spp, seed=seed))
    return image, time.perf_counter() - start


def direct(bsdf=1, emitter=1):
    return mi.load_dict(
        {
            "type": "direct",
            "bsdf_samples": bsdf,
            "emitter_samples": emitter,
            "hide_emitters": True,
        }
    )


def relmse(image, reference, mask):
    a, b = image[mask][:, :3].astype(np.float64), reference[mask][:, :3].astype(np.float64)
    eps = (0.01 * b.mean()) ** 2
    return float(((a - b) ** 2 / (b * b + eps)).mean())


def theirs(options, scene, light, variant):
    """Curves by sampler: lists of (seconds, relMSE), of its multiple importance sampling."""
    mi.set_variant(variant)
    mi.set_log_level(mi.LogLevel.Error)
    centres = variant.startswith("llvm")
    if centres:
        define_centres()
    world = theirs_scene(scene[3], light)
    integrator = direct()
    # Its own reference: many pictures of other seeds than those that are measured.
    sensor = theirs_sensor(options, "multijitter", centres)
    halves, count = [0.0, 0.0], 0
    while count < options.reference:
        for half in range(2):
            image, _ = picture(world, sensor, integrator, 256, 1000 + count)
            halves[half] = halves[half] + image.astype(np.float64)
            count += 1
    reference = (halves[0] + halves[1]) / count
    mask = reference[..., 3] > 0.999
    # The variance of a mean of two halves is a fourth of that of their difference.
    floor = relmse(halves[0] * 2 / count, halves[1] * 2 / count, mask) / 4
    curves = {}
    for sampler in SAMPLERS:
        sensor = theirs_sensor(options, sampler, centres)
        curve = []
        for spp in [16, 64, 256, 1024]:
            if curve and 3 * curve[-1][0] > 2 * options.time:
                break
            picture(world, sensor, integrator, spp, 1)  # its compiler
            runs = [picture(world, sensor, integrator, spp, 2 + seed) for seed in range(SEEDS)]
            seconds = statistics.median(seconds for _, seconds in runs)
            error = statistics.fmean(relmse(image, reference, mask) for image, _ in runs)
            curve.append((seconds, max(error - floor, 1e-12)))
        curves[sampler] = curve
    return curves, reference, floor


# ------------------------------------------------------------------------------------------------------ both


def at(curve, seconds):
    """relMSE after a time, between or beyond steps by logarithms."""
    points = [(math.log(s), math.log(max(e, 1e-12))) for s, e in curve]
    if len(points) == 1:
        return math.exp(points[0][1] + points[0][0] - math.log(seconds))
    x = math.log(seconds)
    index = max(1, min(len(points) - 1, sum(p[0] < x for p in points)))
    (x0, y0), (x1, y1) = points[index - 1], points[index]
    return math.exp(y0 + (y1 - y0) * (x - x0) / (x1 - x0))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--brdf", default="target/release/brdf", help="the program")
    parser.add_argument("--time", type=float, default=0.5, help="the time that is compared at [s]")
    parser.add_argument("--resolution", type=int, default=128)
    parser.add_argument(
        "--replicates", type=int, default=2, help="our replicates: fewer are more accurate; Mitsuba has none"
    )
    parser.add_argument("--width", type=int, default=1024, help="the map's width in texels")
    parser.add_argument("--reference", type=int, default=64, help="pictures of 256 samples in Mitsuba's reference")
    parser.add_argument("--vulkan", default="llvmpipe", help="our second device; empty for none")
    parser.add_argument("--scalar", action="store_true", help="also Mitsuba's scalar variant")
    parser.add_argument("--only", default="", help="scenes whose name has this in it")
    parser.add_argument("--pictures", default="", help="a folder for Mitsuba's references")
    parser.add_argument("--markdown", default="", help="write the table here, too")
    options = parser.parse_args()

    variants = ["llvm_ad_rgb"] + (["scalar_rgb"] if options.scalar else [])
    devices = ["cpu"] + ([options.vulkan] if options.vulkan else [])
    lines = [
        f"relMSE after {options.time:g} s of rendering, {options.resolution}x{options.resolution}, "
        f"{options.replicates} replicates; Mitsuba {mi.__version__}",
        "",
        "| scene | Mitsuba | its best sampler | ours, `mis-balance` | ours, best |"
        + "".join(f" ours, best, on {device} |" for device in devices[1:])
        + " Mitsuba / ours | its best / ours | its best / `mis-balance` |",
        "|---" * (7 + len(devices)) + "|",
    ]
    over_default, over_best, same_over_best = [], [], []
    scalar_lines = []
    for scene in SCENES:
        if options.only not in scene[0]:
            continue
        with tempfile.TemporaryDirectory() as folder:
            light = os.path.join(folder, "map.exr")
            made = subprocess.run(
                [options.brdf, "env", scene[4], "--width", str(options.width), "-o", light],
                capture_output=True,
                text=True,
            )
            if made.returncode != 0:
                sys.exit(made.stderr.strip())
            found = {variant: theirs(options, scene, light, variant) for variant in variants}
        curves, reference, floor = found["llvm_ad_rgb"]
        if options.pictures:
            os.makedirs(options.pictures, exist_ok=True)
            name = scene[0].replace(" ", "-")
            mi.Bitmap(reference.astype(np.float32)).write(os.path.join(options.pictures, f"{name}.exr"))
        mine = [ours(options, scene, device) for device in devices]
        best = {s: at(curve, options.time) for s, curve in curves.items()}
        sampler = min(best, key=best.get)
        here = [{i: at(curve, options.time) for i, curve in one[0].items()} for one in mine]
        winners = [min(one, key=one.get) for one in here]
        lowest = here[0][winners[0]]
        over_default.append(best["independent"] / lowest)
        over_best.append(best[sampler] / lowest)
        same_over_best.append(best[sampler] / here[0]["mis-balance"])
        cells = [scene[0], f"{best['independent']:.1e}", f"{best[sampler]:.1e} {sampler}"]
        cells += [f"{here[0]['mis-balance']:.1e}"]
        cells += [f"{one[winner]:.1e} `{winner}`" for one, winner in zip(here, winners)]
        cells += [f"{one[-1]:.1f}" for one in (over_default, over_best, same_over_best)]
        lines.append("| " + " | ".join(cells) + " |")
        print(lines[-1], f"(references' own relMSE: ours {mine[0][1]:.0e}, Mitsuba's {floor:.0e})", flush=True)
        if options.scalar:
            slow = {s: at(curve, options.time) for s, curve in found["scalar_rgb"][0].items()}
            scalar = min(slow, key=slow.get)
            scalar_lines.append(
                f"| {scene[0]} | {slow['independent']:.1e} | {slow[scalar]:.1e} {scalar} |"
            )
    if len(over_best) > 1:
        lines += [
            "",
            f"In the median {statistics.median(over_default):.1f} times less than its default sampler and "
            f"{statistics.median(over_best):.1f} times less than its best, lower in "
            f"{sum(r > 1 for r in over_best)} of {len(over_best)} scenes; `mis-balance` alone "
            f"{statistics.median(same_over_best):.1f} times less than its best.",
        ]
    if scalar_lines:
        lines += ["", "Mitsuba's scalar variant, whose rays lie anywhere in the pixel:", ""]
        lines += ["| scene | independent | its best sampler |", "|---|---|---|", *scalar_lines]
    text = "\n".join(lines) + "\n"
    print(text)
    if options.markdown:
        with open(options.markdown, "w") as file:
            file.write(text)


if __name__ == "__main__":
    main()
