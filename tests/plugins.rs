//! Every plugin of the tree links with every other and is held to the laws, one test for each plugin and law;
//! every broken one is refused in its author's words.
//!
//! Plugins are found by looking into the tree, so the tests have a runner of their own.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Arc, Once, OnceLock};

use brdf_host::conformance::{Law, Outcome, References, Report, Wanted, conform, subject};
use brdf_host::exec::cpu::Cpu;
use brdf_host::exec::{Precision, open};
use brdf_host::link::{Form, View, link};
use brdf_host::plugin::Configured;
use brdf_host::session::{Chosen, Session};
use brdf_sdk::{Kind, Manifest, Problem};
use common::native::built;
use common::{brdf, integrator, registry, root};
use libtest_mimic::{Arguments, Failed, Trial};

fn main() -> ExitCode {
    let mut trials = vec![
        trial("every_brdf_links_with_every_integrator", every_brdf_links_with_every_integrator),
        trial("the_formats_are_as_their_document_says", the_formats_are_as_their_document_says),
        trial("every_broken_case_gets_its_message", every_broken_case_gets_its_message),
        trial("the_catalogue_is_whole", the_catalogue_is_whole),
    ];
    trials.extend(laws());
    trials.extend(deep());
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}

fn trial(name: &str, test: fn()) -> Trial {
    Trial::test(name, move || {
        test();
        Ok(())
    })
}

/// Folders of BRDFs in the tree: the catalogue, and the examples.
fn folders() -> Vec<PathBuf> {
    let inside = |folder: &str| {
        let entries = fs::read_dir(root().join(folder)).unwrap();
        entries.map(|entry| entry.unwrap().path()).collect::<Vec<_>>()
    };
    let mut all = [inside("plugins/brdf"), inside("examples")].concat();
    all.retain(|folder| folder.join("plugin.toml").exists());
    all.sort();
    // Native ones stand alone and are built where they lie.
    static BUILT: Once = Once::new();
    BUILT.call_once(|| {
        for folder in all.iter().filter(|folder| folder.join("Cargo.toml").exists()) {
            built(folder.clone());
        }
    });
    all
}

/// What is found of a BRDF, once for all of its laws.
type Found = Arc<OnceLock<Result<Report, String>>>;

/// The laws first and the BRDFs second, so that threads that begin together begin with different BRDFs.
fn laws() -> Vec<Trial> {
    let folders: Vec<(PathBuf, Found)> =
        folders().into_iter().map(|folder| (folder, Found::default())).collect();
    let mut trials = Vec::new();
    for law in Law::ALL {
        for (folder, found) in &folders {
            let id = folder.file_name().unwrap().to_str().unwrap();
            let (folder, found) = (folder.clone(), Arc::clone(found));
            trials.push(Trial::test(format!("law::{}::{id}", law.word()), move || {
                let report = found.get_or_init(|| judged(&folder));
                holds(report.as_ref().map_err(Failed::from)?, law)
            }));
        }
    }
    trials
}

/// Those laws that are quick although they look deep, on the cores.
fn deep() -> Vec<Trial> {
    let trial = |folder: PathBuf| {
        let id = folder.file_name().unwrap().to_str().unwrap().to_owned();
        Trial::test(format!("deep::{id}"), move || {
            let brdf = opened(&folder).map_err(|problem| problem.to_string())?;
            let laws = [Law::Finite, Law::Reciprocity, Law::Energy, Law::Weight, Law::Stability];
            let wanted = Wanted { laws: laws.to_vec(), deep: true, ..Wanted::default() };
            let report = conform(&mut Cpu::new(Precision::F32), &brdf, &wanted);
            let report = report.map_err(|problem| problem.to_string())?;
            laws.into_iter().try_for_each(|law| holds(&report, law))
        })
    };
    folders().into_iter().map(trial).collect()
}

fn holds(report: &Report, law: Law) -> Result<(), Failed> {
    let verdict = report.verdicts.iter().find(|verdict| verdict.law == law);
    let verdict = verdict.ok_or("the law said nothing")?;
    match verdict.outcome {
        Outcome::Failed => Err(Failed::from(format!("on {}: {verdict:#?}", report.device))),
        Outcome::Passed | Outcome::Skipped | Outcome::Reported => Ok(()),
    }
}

/// On the device that the program would choose.
fn judged(folder: &Path) -> Result<Report, String> {
    let told = |problem: Problem| problem.to_string();
    let brdf = opened(folder).map_err(told)?;
    let integrators = registry().all(Kind::Integrator).into_iter();
    // The fixtures' integrators are wrong on purpose.
    let own =
        integrators.filter(|found| root().join("plugins/integrator").join(&found.id).is_dir());
    let wanted = Wanted {
        integrators: own.map(|found| integrator(&found.id, &[])).collect(),
        references: references(&brdf).map_err(told)?,
        ..Wanted::default()
    };
    let mut executor = open(None, Precision::F32).map_err(told)?.executor;
    conform(executor.as_mut(), &brdf, &wanted).map_err(told)
}

fn opened(folder: &Path) -> Result<Configured, Problem> {
    Ok(Chosen::find(&registry(), Kind::Brdf, folder.to_str().unwrap())?.configured)
}

/// The files of tests/references about a BRDF.
fn references(brdf: &Configured) -> Result<Vec<References>, Problem> {
    let entries = fs::read_dir(root().join("tests/references")).unwrap();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files.retain(|file| subject(file).is_ok_and(|id| id == brdf.plugin.id));
    files.iter().map(|file| References::load(file, &brdf.plugin)).collect()
}

/// What a manual page needs is in every manifest, and each BRDF that is not read from a file names the preset that
/// reflects most.
fn the_catalogue_is_whole() {
    for folder in folders() {
        let manifest = &opened(&folder).unwrap().plugin.manifest;
        let whole = manifest.formula.is_some()
            && !manifest.sources.is_empty()
            && (manifest.laws.white.is_some() || manifest.files().next().is_some())
            && manifest.params.iter().all(|param| !param.about.is_empty());
        assert!(whole, "{}: formula, sources, [laws] white", folder.display());
    }
    let entries = fs::read_dir(root().join("tests/references")).unwrap();
    for file in entries.map(|entry| entry.unwrap().path()) {
        let about = subject(&file).unwrap();
        assert!(folders().iter().any(|folder| folder.ends_with(&about)), "{}", file.display());
    }
}

fn every_brdf_links_with_every_integrator() {
    let registry = registry();
    let brdfs = registry.all(Kind::Brdf);
    let integrators = registry.all(Kind::Integrator);
    assert!(brdfs.len() >= 3 && integrators.len() >= 2);
    for b in &brdfs {
        for i in &integrators {
            link(&View::Film {
                brdf: brdf(&b.id, &[]),
                integrator: integrator(&i.id, &[]),
                form: Form::default(),
            })
            .unwrap_or_else(|problem| panic!("{} with {}: {problem}", b.id, i.id));
        }
        link(&View::Eval { brdf: brdf(&b.id, &[]) }).unwrap();
    }
}

/// The examples in the document of the formats are whole files, and are read here as such.
fn the_formats_are_as_their_document_says() {
    let text = fs::read_to_string(root().join("docs/formats.md")).unwrap();
    let blocks: Vec<&str> =
        text.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    let [plugin, scene] = blocks[..] else { panic!("{} examples", blocks.len()) };
    let manifest =
        Manifest::parse("plugin.toml", plugin, "velvet").unwrap_or_else(|p| panic!("{p}"));
    assert_eq!(manifest.params.len(), 5);
    let session = Session::parse(&registry(), "scene.toml", scene, Path::new("."));
    let session = session.unwrap_or_else(|problem| panic!("{problem}"));
    // Written and read again it is the same.
    let written = session.to_toml();
    let again = Session::parse(&registry(), "scene.toml", &written, Path::new("")).unwrap();
    assert_eq!(again, session, "{written}");
}

/// Each folder under tests/cases holds a broken plugin or scene and the whole message that it gets.
/// BRDF_BLESS=1 writes the messages instead; look at them before you commit.
fn every_broken_case_gets_its_message() {
    let folder = root().join("tests/cases");
    let mut wrong = Vec::new();
    let mut seen = 0;
    for entry in fs::read_dir(&folder).unwrap() {
        let case = entry.unwrap().path();
        seen += 1;
        let problem = match refusal(&case) {
            Some(problem) => problem.to_string(),
            None => String::from("(accepted)"),
        };
        let shown =
            problem.replace(&format!("{}/", case.display()), "").trim_end().to_owned() + "\n";
        let expected_file = case.join("expected_error.txt");
        if std::env::var_os("BRDF_BLESS").is_some() {
            fs::write(&expected_file, &shown).unwrap();
        }
        let expected = fs::read_to_string(&expected_file).unwrap_or_default();
        if shown != expected {
            wrong.push(format!("{}:\n{shown}instead of\n{expected}", case.display()));
        }
    }
    assert!(seen > 60, "the cases are gone");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn refusal(case: &Path) -> Option<Problem> {
    let scene = case.join("scene.toml");
    if scene.exists() {
        let source = fs::read_to_string(&scene).unwrap();
        return Session::parse(&registry(), "scene.toml", &source, case).err();
    }
    let path = case.to_str().unwrap();
    let manifest = fs::read_to_string(case.join("plugin.toml")).unwrap();
    let view = |kind| {
        let found = Chosen::find(&registry(), kind, path)?.configured;
        Ok(match kind {
            Kind::Brdf => View::Film {
                brdf: found,
                integrator: integrator("brdf-is", &[]),
                form: Form::default(),
            },
            Kind::Integrator => {
                View::Film { brdf: brdf("ggx", &[]), integrator: found, form: Form::default() }
            }
        })
    };
    let kind =
        if manifest.contains("kind = \"integrator\"") { Kind::Integrator } else { Kind::Brdf };
    if let Err(problem) = view(kind).and_then(|view| link(&view)) {
        return Some(problem);
    }
    // What links may still be a mistake.
    let brdf = opened(case).ok()?;
    let wanted = Wanted { laws: vec![Law::Contract], ..Wanted::default() };
    let report = match conform(&mut Cpu::new(Precision::F32), &brdf, &wanted) {
        Ok(report) => report,
        Err(problem) => return Some(problem),
    };
    let verdict = report.verdicts.into_iter().find(|verdict| verdict.outcome == Outcome::Failed)?;
    let shown = verdict.reproduce.map(|input| format!(" ({input})")).unwrap_or_default();
    Some(Problem::new("contract", verdict.said + &shown, ""))
}
