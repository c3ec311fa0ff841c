//! The instructions of a flat program: what they do, and what they read and write.
//!
//! A register holds one scalar of every lane (varying) or one scalar for all of them (uniform). There
//! are two banks: floats, whose type the precision decides, and 32-bit words for integers and masks
//! (a boolean is 0 or !0).

/// A register: an index into the lowering's table, later a slot of its bank.
pub(crate) type Reg = u32;

/// No register.
pub(crate) const NONE: Reg = u32::MAX;

/// Where a register lives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum Bank {
    /// Floats of the run's precision.
    Float,
    /// 32-bit words: i32, u32, booleans as masks.
    Word,
}

/// float <- float
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum F1 {
    Neg,
    Abs,
    Sign,
    Sqrt,
    InverseSqrt,
    Floor,
    Ceil,
    Trunc,
    Round,
    Fract,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Asinh,
    Acosh,
    Atanh,
    Exp,
    Exp2,
    Ln,
    Log2,
    Radians,
    Degrees,
    QuantizeF16,
    FrexpFract,
}

/// float <- float, float
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum F2 {
    Add,
    Sub,
    Mul,
    Div,
    Min,
    Max,
    Atan2,
    Pow,
}

/// float <- float, float, float
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum F3 {
    /// a b + c, rounded once.
    Fma,
    /// a b + c, rounded twice.
    MulAdd,
    /// a b - c, rounded twice.
    MulSub,
    /// c - a b, rounded twice.
    SubMul,
}

/// word (a mask) <- float, float
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Compare {
    Equal,
    NotEqual,
    Less,
    LessEqual,
}

/// word <- float
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum ToWord {
    I32,
    U32,
    /// The bits of the value rounded to f32.
    Bits,
    FrexpExponent,
    /// The bits of the value rounded to f16.
    Half,
}

/// float <- word
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum FromWord {
    I32,
    U32,
    Bits,
    /// From the bits of an f16.
    Half,
    /// 2 to the power of an i32.
    PowerOfTwo,
}

/// word <- word
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum U1 {
    Not,
    AbsI,
    ReverseBits,
    CountOneBits,
    LeadingZeros,
    TrailingZeros,
}

/// word <- word, word
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum U2 {
    Add,
    Sub,
    Mul,
    DivU,
    DivI,
    RemU,
    RemI,
    And,
    Or,
    Xor,
    /// a & !b
    AndNot,
    ShiftLeft,
    ShiftRightU,
    ShiftRightI,
    MinU,
    MaxU,
    MinI,
    MaxI,
    Equal,
    NotEqual,
    LessU,
    LessEqualU,
    LessI,
    LessEqualI,
}

/// What an atomic does to its word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum AtomicOp {
    Add,
    Sub,
    And,
    Or,
    Xor,
    MinU,
    MaxU,
    MinI,
    MaxI,
    Exchange,
}

/// A value that differs by invocation or workgroup.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Builtin {
    GlobalId(u8),
    LocalId(u8),
    LocalIndex,
    GroupId(u8),
    /// A mask of the lanes that stand for an invocation.
    Active,
}

/// How the texels of a texture are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum Texels {
    /// As they lie in memory: what `Op::Texel` gives.
    AsTheyLie,
    /// In rows of 2 to this power, whatever the texture's width: the low bits of a number are x, the others y. A list
    /// is kept in a texture so, and where its rows are that wide the number is the texel's.
    InRows(u8),
}

/// One instruction's work. The comments name the operands `a`, `b`, `c` and the two immediates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Op {
    F1(F1),
    F2(F2),
    F3(F3),
    Compare(Compare),
    ToWord(ToWord),
    FromWord(FromWord),
    U1(U1),
    U2(U2),
    /// Word a turned to the left by `imm` bits.
    Turn,
    /// The bits of word a from bit `imm` on that the mask `extra` lets through, as a word or as a float.
    Field(Bank),
    /// a (a mask) ? b : c
    Select(Bank),
    /// d = a, d uniform or varying as a is.
    Move(Bank),
    /// d = a in all lanes, a uniform.
    Splat(Bank),
    /// d = b (a mask) ? a : d
    Merge(Bank),
    /// A constant: the bits of an f32, or a word, in `imm`.
    Constant(Bank),
    /// Varying word.
    Builtin(Builtin),
    /// Number of workgroups along axis `imm`, uniform.
    GroupCount,
    /// The word at a + `imm` of read-only buffer `extra`.
    Load(Bank),
    /// The word at a + `imm` of writable buffer `extra`, in program order.
    LoadOrdered(Bank),
    /// Word a + `imm` of buffer `extra` becomes b where c is set.
    Store(Bank),
    /// As Store, on a shared word; d is the value before.
    Atomic(AtomicOp),
    /// Words of buffer `extra`, uniform.
    BufferWords,
    /// Index of the texel at (a, b) of texture `extra`, clamped.
    Texel,
    /// Component `imm` of texel a of texture `extra`, of floats or of words.
    Fetch(Bank, Texels),
    /// All four components of texel a of texture `extra`, to the registers d, b, c and `imm`.
    FetchAll(Bank, Texels),
    /// Width or height (`imm`) of texture `extra`, uniform.
    TextureSize,
    /// The element of the lane's own memory at a + `imm`, below `extra`.
    Recall(Bank),
    /// Element a + `imm` of the lane's own memory, below `extra`, becomes b where c is set.
    Keep(Bank),
    /// `extra` elements of the lane's own memory from `imm` on become zero where a is set.
    Clear(Bank),
    /// Element a of table `imm`, of constants.
    Table(Bank),
    /// Counts the lanes of b in which the float a is negative, under watch `imm`.
    WatchNegative,
}

impl Op {
    /// Bank of the result; `None` where there is none.
    pub(crate) fn result(self) -> Option<Bank> {
        Some(match self {
            Op::F1(_) | Op::F2(_) | Op::F3(_) | Op::FromWord(_) => Bank::Float,
            Op::Compare(_) | Op::ToWord(_) | Op::U1(_) | Op::U2(_) | Op::Turn | Op::Builtin(_) => {
                Bank::Word
            }
            Op::GroupCount | Op::BufferWords | Op::Texel | Op::TextureSize | Op::Atomic(_) => {
                Bank::Word
            }
            Op::Field(bank)
            | Op::Select(bank)
            | Op::Move(bank)
            | Op::Splat(bank)
            | Op::Merge(bank)
            | Op::Constant(bank)
            | Op::Load(bank)
            | Op::LoadOrdered(bank)
            | Op::Recall(bank)
            | Op::Table(bank)
            | Op::Fetch(bank, _)
            | Op::FetchAll(bank, _) => bank,
            Op::Store(_) | Op::Keep(_) | Op::Clear(_) | Op::WatchNegative => return None,
        })
    }

    /// Whether the result follows from the operands alone, so that it may be shared and moved.
    pub(crate) fn is_pure(self) -> bool {
        !matches!(
            self,
            Op::Move(_)
                | Op::Merge(_)
                | Op::LoadOrdered(_)
                | Op::Store(_)
                | Op::Atomic(_)
                | Op::Recall(_)
                | Op::Keep(_)
                | Op::Clear(_)
                | Op::WatchNegative
        )
    }

    /// Whether it must run though nothing reads its result.
    pub(crate) fn has_effect(self) -> bool {
        matches!(
            self,
            Op::Store(_) | Op::Atomic(_) | Op::Keep(_) | Op::Clear(_) | Op::WatchNegative
        )
    }

    /// Whether `a` and `b` may change places.
    pub(crate) fn commutes(self) -> bool {
        matches!(
            self,
            Op::F2(F2::Add | F2::Mul)
                | Op::Compare(Compare::Equal | Compare::NotEqual)
                | Op::U2(
                    U2::Add
                        | U2::Mul
                        | U2::And
                        | U2::Or
                        | U2::Xor
                        | U2::MinU
                        | U2::MaxU
                        | U2::MinI
                        | U2::MaxI
                        | U2::Equal
                        | U2::NotEqual
                )
        )
    }

    /// Whether it takes uniform operands beside varying ones; others want all of them varying.
    pub(crate) fn mixes(self) -> bool {
        matches!(
            self,
            Op::F1(_)
                | Op::F2(_)
                | Op::Compare(_)
                | Op::ToWord(_)
                | Op::FromWord(_)
                | Op::U1(_)
                | Op::U2(_)
        )
    }
}

/// One instruction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Inst {
    pub op: Op,
    pub d: Reg,
    pub a: Reg,
    pub b: Reg,
    pub c: Reg,
    pub imm: u32,
    pub extra: u32,
    /// Index of the place in the text that it comes from.
    pub span: u32,
}

impl Inst {
    /// The registers that it reads.
    pub(crate) fn reads(&self) -> impl Iterator<Item = Reg> {
        let own = matches!(self.op, Op::Merge(_)).then_some(self.d);
        let operands = match self.op {
            Op::FetchAll(..) => [self.a, NONE, NONE],
            _ => [self.a, self.b, self.c],
        };
        operands.into_iter().filter(|reg| *reg != NONE).chain(own)
    }

    /// The registers that it writes.
    pub(crate) fn writes(&self) -> impl Iterator<Item = Reg> {
        let results = match self.op {
            Op::FetchAll(..) => [self.d, self.b, self.c, self.imm],
            _ => [self.d, NONE, NONE, NONE],
        };
        results.into_iter().filter(|reg| *reg != NONE)
    }
}

/// A program before it is laid out flat.
#[derive(Debug, Clone)]
pub(crate) enum Node {
    Inst(Inst),
    /// Passed over where `test` is set in no lane.
    Region {
        test: Reg,
        body: Vec<Node>,
    },
    /// Runs again and again: while a lane of `live` is left, or (uniform) until an exit.
    Loop {
        id: u32,
        live: Option<Reg>,
        body: Vec<Node>,
        next: Vec<Node>,
        span: u32,
    },
    /// Leaves a uniform loop.
    Exit(u32),
    /// Goes on with the `next` part of a uniform loop.
    Next(u32),
}
