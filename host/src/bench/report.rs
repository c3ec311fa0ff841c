//! What was found: figures of every cell, as JSON and as rows.

use std::fmt::Write as _;

use brdf_sdk::{Problem, Result};
use serde::{Deserialize, Serialize};

use super::figures::{finite, seconds_to, slope};
use super::{Errors, Limits, Spread};

/// The integrator that efficiencies are held against.
pub const PLAIN: &str = "uniform";

/// Figures of speed that spread wider than this part of them come from a machine that did other things.
const UNDISTURBED: f64 = 0.25;

/// A whole run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// The program's version.
    pub version: String,
    /// How far each cell was taken.
    pub limits: Limits,
    /// The devices.
    pub devices: Vec<DeviceReport>,
    /// The scenes.
    pub cases: Vec<CaseReport>,
    /// Every integrator on every scene on every device.
    pub cells: Vec<CellReport>,
}

/// A device.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DeviceReport {
    /// Its name.
    pub name: String,
    /// Million samples a second of the kernel that is the same everywhere.
    pub calibration: Spread,
    /// Whether its figures of speed spread too wide to be believed.
    pub disturbed: bool,
}

/// A scene and its reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CaseReport {
    /// Its name.
    pub name: String,
    /// What it is about; nothing where nobody says.
    pub about: String,
    /// The scene as TOML; `brdf render --session` renders it.
    pub scene: String,
    /// The BRDF's name and the map's, for tables of both.
    pub brdf: String,
    /// The map's name.
    pub map: String,
    /// Pixels that are covered.
    pub covered_pixels: usize,
    /// The hash of all that the reference depends on.
    pub reference: String,
    /// How the reference was made, and what samples say of it.
    pub reference_said: String,
    /// The reference's own relMSE, estimated.
    pub reference_relmse: f64,
    /// What is worth telling of the scene.
    pub notes: Vec<String>,
}

/// One integrator on one scene on one device.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CellReport {
    /// The device's name.
    pub device: String,
    /// The scene's name.
    pub case: String,
    /// The integrator's id.
    pub integrator: String,
    /// Why there are no figures, where there are none.
    pub problem: Option<String>,
    /// Linking and validating [s].
    pub link: Option<Spread>,
    /// The device's compiler, and bringing there what the program reads [s].
    pub compile: Option<Spread>,
    /// Where samples had doubled; of a sum over texels its end alone.
    pub steps: Vec<Step>,
    /// Of a sum over texels: those that were added, and all.
    pub texels: Option<[u32; 2]>,
    /// Million samples, or texels, of pixels in a second.
    pub rate: Option<Spread>,
    /// That rate as a part of the calibration's.
    pub relative_rate: Option<f64>,
    /// By what power of the samples the relMSE falls, over the last steps: -1 for independent samples.
    pub slope: Option<f64>,
    /// Time to the target relMSE [s], between steps by their logarithms; none where it was not reached.
    pub seconds_to_target: Option<f64>,
    /// 1 / (MSE s) at the last step.
    pub efficiency: Option<f64>,
    /// That as a multiple of the plain integrator's.
    pub over_plain: Option<f64>,
    /// That as a part of the best one's of this scene.
    pub of_best: Option<f64>,
    /// Memory of the process at its peak [bytes], where the system tells.
    pub peak_memory: Option<u64>,
}

/// Where samples had doubled.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// Samples of a pixel; 0 of a sum.
    pub spp: u64,
    /// Time of rendering [s].
    pub seconds: Spread,
    /// The dispatches' own part of it, by the device's clock [s]; none where it has none.
    pub device_seconds: Option<Spread>,
    /// Errors against the reference.
    pub errors: Errors,
}

impl CellReport {
    pub(super) fn new(device: &str, case: &str, integrator: &str) -> Self {
        Self {
            device: device.to_owned(),
            case: case.to_owned(),
            integrator: integrator.to_owned(),
            problem: None,
            link: None,
            compile: None,
            steps: Vec::new(),
            texels: None,
            rate: None,
            relative_rate: None,
            slope: None,
            seconds_to_target: None,
            efficiency: None,
            over_plain: None,
            of_best: None,
            peak_memory: None,
        }
    }

    /// Its last step.
    pub fn last(&self) -> Option<&Step> {
        self.steps.last()
    }

    /// What is wrong with it: samples that are no numbers, a bias that its error does not explain, an estimate of its own
    /// error that is off by more than a factor of two. Nothing where all of that is right, or where the error is no larger
    /// than ten times the reference's own (`floor`), which then decides all of that.
    pub fn faults(&self, floor: f64) -> Vec<String> {
        let mut faults: Vec<String> = self.problem.iter().cloned().collect();
        let Some(Step { errors, .. }) = self.last() else { return faults };
        if errors.nonfinite > 0 {
            faults.push(format!("{} samples were Inf or NaN", errors.nonfinite));
        }
        if let Some([done, of]) = self.texels.filter(|_| self.unfinished()) {
            let part = 100.0 * f64::from(done) / f64::from(of);
            faults.push(format!("time ended it after {part:.0} % of the texels"));
        }
        if errors.relmse <= 10.0 * floor {
            return faults;
        }
        let bias = errors.bias_std_error.filter(|error| *error > 0.0).map(|e| errors.bias / e);
        if let Some(z) = bias.filter(|z| z.abs() > 3.0) {
            faults.push(format!("its mean is {z:.1} standard errors off"));
        }
        if let Some(own) = errors.estimate.filter(|_| errors.relmse > 0.0) {
            let factor = own / errors.relmse;
            if !(0.5..=2.0).contains(&factor) {
                faults.push(format!("it takes its error for {factor:.2} of what it is"));
            }
        }
        faults
    }

    /// Whether the sum ended before its last texel.
    pub fn unfinished(&self) -> bool {
        self.texels.is_some_and(|[done, of]| done < of)
    }

    /// What follows from its steps alone.
    pub(super) fn derive(&mut self, pixels: usize, target: f64, calibration: f64) {
        let Some(last) = self.steps.last().copied() else { return };
        let work = match self.texels {
            Some([done, _]) => f64::from(done),
            None => last.spp as f64,
        };
        let rate = last.seconds.map(|seconds| work * pixels as f64 / seconds.max(1e-9) / 1e6);
        self.rate = Some(rate);
        self.relative_rate = finite(rate.median / calibration);
        let product = last.errors.mse * last.seconds.median;
        self.efficiency = finite(1.0 / product);
        self.slope = slope(&self.steps);
        self.seconds_to_target = seconds_to(&self.steps, target);
    }
}

impl Report {
    pub(super) fn new(limits: &Limits) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            limits: *limits,
            devices: Vec::new(),
            cases: Vec::new(),
            cells: Vec::new(),
        }
    }

    /// What follows from all cells together.
    pub(super) fn derive(&mut self) {
        for index in 0..self.cells.len() {
            let beside = |other: &&CellReport| {
                let cell = &self.cells[index];
                other.case == cell.case && other.device == cell.device
            };
            let others = || self.cells.iter().filter(beside);
            let plain = others().find(|cell| cell.integrator == PLAIN);
            let plain = plain.and_then(|cell| cell.efficiency);
            let best = others().filter_map(|cell| cell.efficiency).fold(0.0, f64::max);
            let own = self.cells[index].efficiency;
            let over_plain = own.zip(plain).and_then(|(own, plain)| finite(own / plain));
            let of_best = own.and_then(|own| finite(own / best));
            let cell = &mut self.cells[index];
            (cell.over_plain, cell.of_best) = (over_plain, of_best);
        }
        for device in &mut self.devices {
            let cells = self.cells.iter().filter(|cell| cell.device == device.name);
            let spreads = cells.filter_map(|cell| Some(cell.rate?.relative()));
            let usual = Spread::of(spreads).map_or(0.0, |spread| spread.median);
            device.disturbed = device.calibration.relative().max(usual) > UNDISTURBED;
        }
    }

    /// The cells of a scene on a device, those with the least relMSE times seconds first; those without figures, and
    /// those with samples that are no numbers, last.
    pub fn ranked(&self, device: &str, case: &str) -> Vec<&CellReport> {
        let of = |cell: &&CellReport| cell.device == device && cell.case == case;
        let mut cells: Vec<&CellReport> = self.cells.iter().filter(of).collect();
        let rank = |cell: &&CellReport| {
            let product = cell.last().map(|last| last.errors.relmse * last.seconds.median);
            let sound = cell.last().is_some_and(|last| last.errors.nonfinite == 0);
            product.filter(|_| sound && !cell.unfinished()).unwrap_or(f64::INFINITY)
        };
        cells.sort_by(|a, b| rank(a).total_cmp(&rank(b)));
        cells
    }

    /// As JSON; numbers that are none are null.
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// Reads what `to_json` wrote.
    ///
    /// # Errors
    /// Where the text is something else.
    pub fn from_json(name: &str, text: &str) -> Result<Self> {
        serde_json::from_str(text).map_err(|error| {
            Problem::new(
                name,
                format!("this is no report of `brdf bench` ({error})"),
                "give what --json wrote",
            )
        })
    }

    /// A row for every step of every cell, with a head.
    pub fn to_csv(&self) -> String {
        let mut text = "device,case,integrator,spp,texels,seconds,seconds_low,seconds_high,device_seconds,mse,relmse,bias,bias_std_error,flip,estimate,nonfinite,msamples_per_s,link,compile,peak_memory\n".to_owned();
        let quoted = |text: &str| match text.contains([',', '"', '\n']) {
            true => format!("\"{}\"", text.replace('"', "\"\"")),
            false => text.to_owned(),
        };
        let or_nothing = |number: Option<f64>| number.map(|n| n.to_string()).unwrap_or_default();
        for cell in &self.cells {
            for Step { spp, seconds, device_seconds, errors } in &cell.steps {
                let [device, case] = [&cell.device, &cell.case].map(|text| quoted(text));
                let texels = cell.texels.map(|[done, _]| done.to_string()).unwrap_or_default();
                let Errors { mse, relmse, bias, bias_std_error, flip, estimate, nonfinite } =
                    errors;
                let _ = writeln!(
                    text,
                    "{device},{case},{},{spp},{texels},{},{},{},{},{mse},{relmse},{bias},{},{flip},{},{nonfinite},{},{},{},{}",
                    quoted(&cell.integrator),
                    seconds.median,
                    seconds.low,
                    seconds.high,
                    or_nothing(device_seconds.map(|spread| spread.median)),
                    or_nothing(*bias_std_error),
                    or_nothing(*estimate),
                    or_nothing(cell.rate.map(|rate| rate.median)),
                    or_nothing(cell.link.map(|spread| spread.median)),
                    or_nothing(cell.compile.map(|spread| spread.median)),
                    cell.peak_memory.map(|bytes| bytes.to_string()).unwrap_or_default(),
                );
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(spp: u64, seconds: f64, relmse: f64) -> Step {
        let errors = Errors {
            mse: relmse,
            relmse,
            bias: 0.0,
            bias_std_error: Some(0.1),
            flip: 0.0,
            estimate: Some(relmse),
            nonfinite: 0,
        };
        let seconds = Spread { median: seconds, low: seconds, high: seconds };
        Step { spp, seconds, device_seconds: None, errors }
    }

    fn cell(integrator: &str, steps: Vec<Step>) -> CellReport {
        let mut cell = CellReport { steps, ..CellReport::new("cores", "a, b", integrator) };
        cell.derive(100, 1e-2, 10.0);
        cell
    }

    #[test]
    fn figures_follow_from_the_steps() {
        // The error falls as 1 / n: 0.16 at 16 samples, 0.01 at 256, in 1 ms a sample.
        let steps = [16, 32, 64, 128, 256, 512];
        let steps = steps.map(|n| step(n, 1e-3 * n as f64, 2.56 / n as f64)).to_vec();
        let found = cell("uniform", steps);
        assert!((found.slope.unwrap() + 1.0).abs() < 1e-9, "{:?}", found.slope);
        assert!((found.seconds_to_target.unwrap() - 0.256).abs() < 1e-9);
        // 512 samples of 100 pixels in 0.512 s; 1 / (0.005 * 0.512).
        assert!((found.rate.unwrap().median - 0.1).abs() < 1e-9);
        assert!((found.relative_rate.unwrap() - 0.01).abs() < 1e-9);
        assert!((found.efficiency.unwrap() - 390.625).abs() < 1e-6);
        // Between two steps: from 0.02 at 0.128 s to 0.005 at 0.512 s the logarithms meet 0.01 in the middle.
        let between = [step(128, 0.128, 0.02), step(512, 0.512, 0.005)];
        assert!((seconds_to(&between, 0.01).unwrap() - 0.256).abs() < 1e-9);
        assert_eq!(seconds_to(&between, 1e-3), None);
    }

    #[test]
    fn what_is_wrong_is_told_above_the_references_own_error() {
        let mut found = cell("uniform", vec![step(16, 1.0, 0.4)]);
        assert!(found.faults(0.0).is_empty());
        let last = found.steps.last_mut().unwrap();
        (last.errors.bias, last.errors.estimate) = (0.5, Some(0.1));
        // 0.5 of a standard error of 0.1, and 0.1 of 0.4.
        let told = found.faults(0.0);
        assert_eq!(
            told,
            ["its mean is 5.0 standard errors off", "it takes its error for 0.25 of what it is"]
        );
        assert!(found.faults(0.1).is_empty());
        found.steps.last_mut().unwrap().errors.nonfinite = 3;
        assert_eq!(found.faults(0.1), ["3 samples were Inf or NaN"]);
    }

    #[test]
    fn cells_are_held_against_the_plain_one_and_the_best() {
        let limits = Limits::default();
        let mut report = Report::new(&limits);
        report.cells = vec![
            cell("uniform", vec![step(16, 1.0, 0.4)]),
            cell("product", vec![step(16, 2.0, 0.01)]),
            cell("black", vec![step(16, 1.0, 0.0)]),
        ];
        report.derive();
        // 1 / (0.4 * 1) and 1 / (0.01 * 2).
        assert!((report.cells[1].over_plain.unwrap() - 20.0).abs() < 1e-9);
        assert!((report.cells[0].of_best.unwrap() - 0.05).abs() < 1e-9);
        // No error at all has no efficiency, and is the best.
        assert_eq!(report.cells[2].efficiency, None);
        let ranked: Vec<&str> =
            report.ranked("cores", "a, b").iter().map(|cell| cell.integrator.as_str()).collect();
        assert_eq!(ranked, ["black", "product", "uniform"]);

        let back = Report::from_json("old.json", &report.to_json()).unwrap();
        assert_eq!(back, report);
        let problem = Report::from_json("old.json", "[]").unwrap_err();
        assert!(problem.line().starts_with("old.json: this is no report"), "{problem}");
        assert!(
            report
                .to_csv()
                .contains("\ncores,\"a, b\",product,16,,2,2,2,,0.01,0.01,0,0.1,0,0.01,0,")
        );
    }
}
