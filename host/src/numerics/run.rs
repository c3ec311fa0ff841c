//! One of the author's functions, run in f32 beside f64.

use brdf_sdk::{Problem, Result};
use naga::ResourceBinding;
use wgsl_cpu::{Failure, Resource, Run, Site, Storage};

use super::cases::Case;
use super::outcome::Outcome;
use crate::data::{self, Held, texture_size};
use crate::link::{Function, LOOP_ITERATIONS, Program, View, link};
use crate::plugin::Configured;

/// A function ready to run.
pub struct Runner {
    /// The linked program, which knows where its parts come from.
    pub program: Program,
    machine: wgsl_cpu::Program,
}

impl Runner {
    /// Links and lowers a function.
    pub fn new(brdf: &Configured, function: Function) -> Result<Self> {
        let program = link(&View::Numerics { brdf: brdf.clone(), function })?;
        let machine = wgsl_cpu::Program::for_errors(&program.module, &program.types()?)
            .map_err(|refusal| program.refused(&refusal, refusal.span))?;
        Ok(Self { program, machine })
    }

    /// Runs it for each case; also the instructions in which errors arose.
    pub fn run(&self, brdf: &Configured, cases: &[Case]) -> Result<(Vec<Outcome>, Vec<Site>)> {
        self.on(brdf, cases, |run| self.machine.errors(run))
    }

    /// The results in f64, but for the expression at one span, which is off by its local errors.
    pub fn with_errors_of(
        &self,
        span: naga::Span,
        brdf: &Configured,
        cases: &[Case],
    ) -> Result<Vec<[f64; 3]>> {
        let (outcomes, ()) = self.on(brdf, cases, |run| self.machine.errors_of(span, run))?;
        Ok(outcomes.into_iter().map(|outcome| outcome.high).collect())
    }

    fn on<T>(
        &self,
        brdf: &Configured,
        cases: &[Case],
        machine: impl Fn(&Run<'_>) -> Result<T, Failure>,
    ) -> Result<(Vec<Outcome>, T)> {
        let layout = self.program.required_layout("outcomes");
        let stride = layout.stride / 4;
        let outcomes = Storage::new(stride * cases.len(), true);
        let mut inputs = vec![("cases".to_owned(), self.words_of(cases))];
        inputs.extend(
            self.program.parameter_bytes(brdf).map(|(name, bytes)| (name, as_words(&bytes))),
        );
        let (brought, _) = data::of(&self.program, brdf)?;
        let mut resources = Vec::new();
        for binding in &self.program.bindings {
            let known = inputs.iter().find(|(name, _)| *name == binding.name);
            let brought = brought.iter().find(|brought| brought.name == binding.name);
            let resource = match (known, brought) {
                (Some((_, words)), _) => Resource::Words(words),
                (None, Some(brought)) => match &brought.held {
                    Held::Words(_, words) => Resource::Words(words),
                    Held::Texels(_, texels) => {
                        Resource::Texture { size: texture_size(texels), texels }
                    }
                },
                (None, None) => Resource::Storage(&outcomes),
            };
            resources.push((ResourceBinding { group: 0, binding: binding.index }, resource));
        }
        let groups = self.program.groups(cases.len() as u32);
        let fuel = u64::from(LOOP_ITERATIONS) * self.machine.cost();
        let run = Run { resources: &resources, groups, fuel, set: None, lanes: None };
        let found = machine(&run).map_err(|failure| self.told(&failure))?;
        let first = layout.at("value") / 4;
        let channel = |case: usize, at: usize| case * stride + first + at;
        let read = |case: usize| Outcome {
            low: [0, 1, 2]
                .map(|at| f32::from_bits(outcomes.word(channel(case, at)).unwrap_or_default())),
            high: [0, 1, 2].map(|at| outcomes.float(channel(case, at)).unwrap_or_default()),
        };
        Ok(((0..cases.len()).map(read).collect(), found))
    }

    /// The cases as the program lays them out; none where it reads none of them.
    fn words_of(&self, cases: &[Case]) -> Vec<u32> {
        let Some(layout) = self.program.layout("cases") else { return Vec::new() };
        let mut bytes = vec![0; layout.stride * cases.len()];
        for (index, case) in cases.iter().enumerate() {
            for (member, value) in [("wo", &case.wo), ("wi", &case.wi), ("u", &case.u)] {
                layout.write(&mut bytes, index * layout.stride, member, value);
            }
        }
        as_words(&bytes)
    }

    fn told(&self, failure: &Failure) -> Problem {
        match failure {
            Failure::Stopped(stopped) => self.program.problem(
                stopped.span,
                "this loop does not come to an end within 16,384 iterations",
                "look at its condition, or give it a smaller bound",
            ),
            Failure::Missing(_) | Failure::TooMany => Problem::new(
                "the linked program",
                failure.to_string(),
                "report the plugin that causes this",
            ),
        }
    }
}

fn as_words(bytes: &[u8]) -> Vec<u32> {
    bytes.chunks_exact(4).map(bytemuck::pod_read_unaligned).collect()
}
