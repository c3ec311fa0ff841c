//! The processor's vector width, found at run time.
//!
//! A kernel is compiled once for each instruction set and called with a token that proves the set is
//! there: pulp keeps the `unsafe` of that on its side. On ARM, NEON belongs to the base.

use pulp::NullaryFnOnce;
#[cfg(target_arch = "x86_64")]
use pulp::x86::{V3, V4};

/// Proof that an instruction set may be used.
pub(crate) trait Isa: Copy + Send + Sync + 'static {
    /// How many times the precision's own number of lanes a batch has: an instruction has a price of its own, and
    /// where it works fast on its lanes, more of them are to share it.
    const BATCH: usize = 1;

    /// Runs `work` compiled for this instruction set.
    fn run<W: NullaryFnOnce>(self, work: W) -> W::Output;

    /// Rows as columns; inside of [`Isa::run`].
    #[inline(always)]
    fn transposed(self, rows: [[f32; 4]; 4]) -> [[f32; 4]; 4] {
        let mut columns = [[0.0; 4]; 4];
        for row in 0..4 {
            for column in 0..4 {
                columns[column][row] = rows[row][column];
            }
        }
        columns
    }
}

/// Rows as columns, by shuffles: the compiler moves element by element.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn shuffled(sse: pulp::core_arch::x86::Sse, rows: [[f32; 4]; 4]) -> [[f32; 4]; 4] {
    use pulp::cast;
    let [a, b, c, d] = rows;
    let (a, b, c, d) = (cast(a), cast(b), cast(c), cast(d));
    let (low, high) = (sse._mm_unpacklo_ps(a, b), sse._mm_unpackhi_ps(a, b));
    let (lower, higher) = (sse._mm_unpacklo_ps(c, d), sse._mm_unpackhi_ps(c, d));
    [
        cast(sse._mm_movelh_ps(low, lower)),
        cast(sse._mm_movehl_ps(lower, low)),
        cast(sse._mm_movelh_ps(high, higher)),
        cast(sse._mm_movehl_ps(higher, high)),
    ]
}

/// Work that is compiled for each instruction set.
pub(crate) trait WithIsa {
    type Output;
    fn with<A: Isa>(self, isa: A) -> Self::Output;
}

/// What every processor of the target has: SSE2 or NEON.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Base;

impl Isa for Base {
    #[inline(always)]
    fn run<W: NullaryFnOnce>(self, work: W) -> W::Output {
        work.call()
    }
}

#[cfg(target_arch = "x86_64")]
impl Isa for V3 {
    #[inline(always)]
    fn run<W: NullaryFnOnce>(self, work: W) -> W::Output {
        self.vectorize(work)
    }

    #[inline(always)]
    fn transposed(self, rows: [[f32; 4]; 4]) -> [[f32; 4]; 4] {
        shuffled(self.sse, rows)
    }
}

#[cfg(target_arch = "x86_64")]
impl Isa for V4 {
    const BATCH: usize = 2;

    #[inline(always)]
    fn run<W: NullaryFnOnce>(self, work: W) -> W::Output {
        self.vectorize(work)
    }

    #[inline(always)]
    fn transposed(self, rows: [[f32; 4]; 4]) -> [[f32; 4]; 4] {
        shuffled(self.sse, rows)
    }
}

/// The instruction sets that programs run on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VectorSet {
    /// SSE2 on x86-64, NEON on ARM.
    Base,
    /// AVX2 with FMA, 8 lanes of f32.
    Avx2,
    /// AVX-512 (F, BW, CD, DQ, VL), 16 lanes of f32.
    Avx512,
}

impl VectorSet {
    /// The widest one of this processor.
    pub fn best() -> Self {
        let all = Self::all();
        all.last().copied().unwrap_or(Self::Base)
    }

    /// Those of this processor, the widest last.
    pub fn all() -> Vec<Self> {
        [Self::Base, Self::Avx2, Self::Avx512].into_iter().filter(|set| set.is_here()).collect()
    }

    fn is_here(self) -> bool {
        match self {
            Self::Base => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => V3::try_new().is_some(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => V4::try_new().is_some(),
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }

    /// Hands the proof of this instruction set to `work`; of the base where it is not there.
    pub(crate) fn choose<W: WithIsa>(self, work: W) -> W::Output {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 if let Some(isa) = V4::try_new() => work.with(isa),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 if let Some(isa) = V3::try_new() => work.with(isa),
            _ => work.with(Base),
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Base if cfg!(target_arch = "x86_64") => "SSE2",
            Self::Base if cfg!(target_arch = "aarch64") => "NEON",
            Self::Base => "plain",
            Self::Avx2 => "AVX2",
            Self::Avx512 => "AVX-512",
        }
    }
}
