//! A compiled expression: postfix operations on a small fixed stack.

use fractum_math::elementary;

use crate::choice::choice;

/// Deepest stack a program may need; the compiler refuses deeper ones.
const STACK: usize = 32;

/// One postfix operation. Truth is 1, falsehood 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Op {
    /// Push a number.
    Constant(f64),
    /// Push an input.
    Input(u16),
    /// Replace the top.
    Unary(Unary),
    /// Replace the two topmost.
    Binary(Binary),
    /// Replace condition, a, b by a where the condition holds, else b.
    Select,
}

/// Functions of one argument.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Unary {
    Negate,
    Not,
    Abs,
    Sign,
    Sqrt,
    Exp,
    Log,
    Log10,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Floor,
    Ceil,
}

choice!(Unary {
    "-" => Negate, "!" => Not, "abs" => Abs, "sign" => Sign, "sqrt" => Sqrt, "exp" => Exp, "log" => Log,
    "log10" => Log10, "sin" => Sin, "cos" => Cos, "tan" => Tan, "asin" => Asin, "acos" => Acos, "atan" => Atan,
    "sinh" => Sinh, "cosh" => Cosh, "tanh" => Tanh, "floor" => Floor, "ceil" => Ceil,
});

/// Operators and functions of two arguments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Equal,
    NotEqual,
    And,
    Or,
    Min,
    Max,
    Atan2,
    Hypot,
}

choice!(Binary {
    "+" => Add, "-" => Subtract, "*" => Multiply, "/" => Divide, "^" => Power, "<" => Less, "<=" => LessEqual,
    ">" => Greater, ">=" => GreaterEqual, "==" => Equal, "!=" => NotEqual, "&&" => And, "||" => Or,
    "min" => Min, "max" => Max, "atan2" => Atan2, "hypot" => Hypot,
});

/// A compiled expression of numbered inputs; numbers in SI. Evaluation allocates nothing and never panics.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Program {
    code: Box<[Op]>,
}

impl Program {
    /// Takes postfix code; `None` where it is unbalanced or needs too deep a stack.
    pub(crate) fn new(code: Vec<Op>) -> Option<Self> {
        let mut depth = 0usize;
        for op in &code {
            let takes = op.takes();
            depth = depth.checked_sub(takes)? + 1;
            if depth > STACK {
                return None;
            }
        }
        (depth == 1).then(|| Self { code: code.into() })
    }

    /// A program that gives this number.
    pub(crate) fn of_constant(value: f64) -> Self {
        Self { code: Box::new([Op::Constant(value)]) }
    }

    /// The program whose values are larger by a factor; `None` where it needs too deep a stack.
    pub(crate) fn times(self, factor: f64) -> Option<Self> {
        Self::new([&self.code[..], &[Op::Constant(factor), Op::Binary(Binary::Multiply)]].concat())
    }

    /// Value for the given inputs; an input that is not there counts as NaN.
    pub(crate) fn evaluate(&self, inputs: &[f64]) -> f64 {
        let mut stack = [0.0f64; STACK];
        let mut top = 0; // number of values on the stack; `new` has checked that it stays within 1..=STACK
        for op in &self.code {
            let takes = op.takes();
            let first = top - takes;
            stack[first] = match *op {
                Op::Constant(value) => value,
                Op::Input(index) => inputs.get(usize::from(index)).copied().unwrap_or(f64::NAN),
                Op::Unary(function) => function.apply(stack[first]),
                Op::Binary(function) => function.apply(stack[first], stack[first + 1]),
                Op::Select if stack[first] != 0.0 => stack[first + 1],
                Op::Select => stack[first + 2],
            };
            top = first + 1;
        }
        stack[0]
    }

    /// Whether the program reads input number `index`.
    pub(crate) fn reads(&self, index: u16) -> bool {
        self.code.contains(&Op::Input(index))
    }

    /// Value of a program that reads no input.
    pub(crate) fn constant(&self) -> Option<f64> {
        let reads_any = self.code.iter().any(|op| matches!(op, Op::Input(_)));
        (!reads_any).then(|| self.evaluate(&[]))
    }
}

impl Op {
    /// Number of values taken from the stack; one is given back.
    fn takes(&self) -> usize {
        match self {
            Op::Constant(_) | Op::Input(_) => 0,
            Op::Unary(_) => 1,
            Op::Binary(_) => 2,
            Op::Select => 3,
        }
    }
}

impl Unary {
    fn apply(self, a: f64) -> f64 {
        match self {
            Unary::Negate => -a,
            Unary::Not => truth(a == 0.0),
            Unary::Abs => a.abs(),
            Unary::Sign => {
                if a == 0.0 {
                    0.0
                } else {
                    a.signum()
                }
            }
            Unary::Sqrt => a.sqrt(),
            Unary::Exp => elementary::exp(a),
            Unary::Log => elementary::ln(a),
            Unary::Log10 => elementary::log10(a),
            Unary::Sin => elementary::sin(a),
            Unary::Cos => elementary::cos(a),
            Unary::Tan => elementary::tan(a),
            Unary::Asin => elementary::asin(a),
            Unary::Acos => elementary::acos(a),
            Unary::Atan => elementary::atan(a),
            Unary::Sinh => elementary::sinh(a),
            Unary::Cosh => elementary::cosh(a),
            Unary::Tanh => elementary::tanh(a),
            Unary::Floor => a.floor(),
            Unary::Ceil => a.ceil(),
        }
    }
}

impl Binary {
    fn apply(self, a: f64, b: f64) -> f64 {
        match self {
            Binary::Add => a + b,
            Binary::Subtract => a - b,
            Binary::Multiply => a * b,
            Binary::Divide => a / b,
            Binary::Power => elementary::pow(a, b),
            Binary::Less => truth(a < b),
            Binary::LessEqual => truth(a <= b),
            Binary::Greater => truth(a > b),
            Binary::GreaterEqual => truth(a >= b),
            Binary::Equal => truth(a == b),
            Binary::NotEqual => truth(a != b),
            Binary::And => truth(a != 0.0 && b != 0.0),
            Binary::Or => truth(a != 0.0 || b != 0.0),
            Binary::Min => a.min(b),
            Binary::Max => a.max(b),
            Binary::Atan2 => elementary::atan2(a, b),
            Binary::Hypot => elementary::hypot(a, b),
        }
    }
}

fn truth(condition: bool) -> f64 {
    f64::from(u8::from(condition))
}
