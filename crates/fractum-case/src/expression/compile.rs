//! Precedence climbing straight into postfix code, types checked on the way.

use super::ExpressionError;
use super::lexer::{Kind, Token, tokens};
use super::program::{Binary, Op, Program, Unary};
use super::rules::Rules;
use super::types::{Names, Type};
use super::units::unit_after_number;
use crate::tree::shortened;
use crate::unit::{Dimension, Unit};
use crate::{Choice, nearest};

/// Names up to which all are told where one is unknown.
const MOST_NAMES: usize = 20;
/// Deepest nesting of brackets and signs.
const DEEPEST: u32 = 40;

/// A compiled expression with its type.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Compiled {
    pub(crate) program: Program,
    pub(crate) kind: Type,
}

/// Compiles `text`. `lenient`: a factor without unit may carry any dimension.
pub(crate) fn compile(text: &str, names: &mut dyn Names, lenient: bool) -> Result<Compiled, ExpressionError> {
    let tokens = tokens(text)?;
    let mut compiler = Compiler { tokens: &tokens, at: 0, code: Vec::new(), names, rules: Rules { lenient }, depth: 0 };
    let kind = compiler.expression(0)?;
    let left = compiler.peek();
    match left.kind {
        Kind::End => {}
        Kind::Symbol(")") => return Err(ExpressionError::new(left.offset, "\")\" without \"(\"")),
        _ => return Err(ExpressionError::new(left.offset, "expected an operator such as \"*\"")),
    }
    let program =
        Program::new(compiler.code).ok_or_else(|| ExpressionError::new(0, "the expression is nested too deeply"))?;
    Ok(Compiled { program, kind })
}

struct Compiler<'t, 'n> {
    tokens: &'t [Token<'t>],
    at: usize,
    code: Vec<Op>,
    names: &'n mut dyn Names,
    rules: Rules,
    depth: u32,
}

type Result<T, E = ExpressionError> = std::result::Result<T, E>;

/// Strength of a sign before its operand: above products, below powers.
const SIGN: u8 = 6;

/// Strength of an operator; stronger ones bind first.
fn strength(operator: Binary) -> u8 {
    use Binary::*;
    match operator {
        Or => 1,
        And => 2,
        Less | LessEqual | Greater | GreaterEqual | Equal | NotEqual => 3,
        Add | Subtract => 4,
        Multiply | Divide => 5,
        _ => 7,
    }
}

impl<'t> Compiler<'t, '_> {
    fn peek(&self) -> Token<'t> {
        self.tokens[self.at.min(self.tokens.len() - 1)]
    }

    fn next(&mut self) -> Token<'t> {
        let token = self.peek();
        self.at += 1;
        token
    }

    fn expect(&mut self, symbol: &'static str) -> Result<()> {
        let token = self.peek();
        if token.kind != Kind::Symbol(symbol) {
            return Err(ExpressionError::new(token.offset, format!("expected \"{symbol}\"")));
        }
        self.at += 1;
        Ok(())
    }

    /// Compiles operators of at least this strength.
    fn expression(&mut self, weakest: u8) -> Result<Type> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(ExpressionError::new(self.peek().offset, "the expression is nested too deeply"));
        }
        let mut left = self.operand()?;
        loop {
            let token = self.peek();
            let (operator, raised) = match token.kind {
                Kind::Symbol(symbol) => match Binary::NAMES.iter().find(|(name, _)| *name == symbol) {
                    Some((_, operator)) => (*operator, None),
                    None => break,
                },
                Kind::Raised(exponent) => (Binary::Power, Some(exponent)),
                _ => break,
            };
            let strength = strength(operator);
            if strength < weakest {
                break;
            }
            self.at += 1;
            let start = self.code.len();
            let right = match (operator, raised) {
                (_, Some(exponent)) => {
                    self.code.push(Op::Constant(f64::from(exponent)));
                    Type::BARE
                }
                (Binary::Power, None) => self.expression(SIGN)?, // to the right, and signs are welcome: 2^-3^2
                _ => self.expression(strength + 1)?,
            };
            left = if operator == Binary::Power {
                let exponent = Program::new(self.code[start..].to_vec()).and_then(|program| program.constant());
                self.rules.power(left, right, exponent, token.offset)?
            } else {
                self.rules.binary(operator, left, right, token.offset)?
            };
            self.code.push(Op::Binary(operator));
            let chained = matches!(self.peek().kind, Kind::Symbol("<" | "<=" | ">" | ">=" | "==" | "!="));
            if strength == 3 && chained {
                let error = ExpressionError::new(self.peek().offset, "comparisons cannot be chained");
                return Err(error.remedy("write a < b && b < c"));
            }
        }
        self.depth -= 1;
        Ok(left)
    }

    fn operand(&mut self) -> Result<Type> {
        let token = self.next();
        match token.kind {
            Kind::Number(digits) => self.quantity(digits, token.offset),
            Kind::Name(name) => self.name(name, token.offset),
            Kind::Symbol("(") => {
                let inner = self.expression(0)?;
                self.expect(")")?;
                Ok(inner)
            }
            Kind::Symbol("-") => {
                let kind = self.expression(SIGN)?;
                self.code.push(Op::Unary(Unary::Negate));
                self.rules.number(kind, "a sign", token.offset)
            }
            Kind::Symbol("+") => {
                let kind = self.expression(SIGN)?;
                self.rules.number(kind, "a sign", token.offset)
            }
            Kind::Symbol("!") => {
                let kind = self.expression(SIGN)?;
                self.code.push(Op::Unary(Unary::Not));
                if kind == Type::Truth {
                    Ok(kind)
                } else {
                    Err(ExpressionError::new(token.offset, format!("\"!\" needs a condition, not {}", kind.phrase())))
                }
            }
            Kind::End => Err(ExpressionError::new(token.offset, "the expression ends too early")),
            Kind::Symbol(symbol) => Err(ExpressionError::new(token.offset, format!("unexpected \"{symbol}\""))),
            Kind::Raised(_) => Err(ExpressionError::new(token.offset, "an exponent without a base")),
        }
    }

    /// A number with the unit behind it, if any.
    fn quantity(&mut self, digits: &str, offset: usize) -> Result<Type> {
        let start = self.at;
        let unit = unit_after_number(self.tokens, &mut self.at, self.names)?;
        let value = unit.of(digits).filter(|value| value.is_finite());
        let value = value.ok_or_else(|| ExpressionError::new(offset, "the number is too large"))?;
        let scale = if self.at == start { 1.0 } else { self.names.scale_of(unit.dimension) };
        self.code.push(Op::Constant(value * scale));
        Ok(if self.at == start { Type::BARE } else { Type::number(unit.dimension) })
    }

    fn name(&mut self, name: &str, offset: usize) -> Result<Type> {
        let called = self.peek().kind == Kind::Symbol("(");
        // A parameter may have the name of a reduction, which is called.
        if called && (!self.names.contains(name) || self.names.reduces(name)) {
            return self.call(name, offset);
        }
        let found = match name {
            "pi" => {
                self.code.push(Op::Constant(std::f64::consts::PI));
                return Ok(Type::BARE);
            }
            _ => self.names.find(name),
        };
        let Some(found) = found else { return Err(self.unknown(name, offset)) };
        let named = found.map_err(|message| ExpressionError::new(offset, message))?;
        self.code.push(named.op);
        Ok(named.kind)
    }

    fn unknown(&self, name: &str, offset: usize) -> ExpressionError {
        let mut all = self.names.all();
        all.push("pi".to_string());
        let error = ExpressionError::new(offset, format!("unknown name \"{}\"", shortened(name)));
        match nearest(name, all.iter().map(String::as_str)) {
            _ if Unit::find(name).is_some() => error.remedy("a unit stands right behind its number, as in 2 mm"),
            Some(near) => error.remedy(format!("did you mean \"{near}\"?")),
            None if self.continues_unit()
                && let Some(near) = Unit::nearest(name) =>
            {
                error.remedy(format!("did you mean \"{near}\"?"))
            }
            None if all.len() > MOST_NAMES => error,
            None => error.remedy(format!("names here: {}", all.join(", "))),
        }
    }

    /// Whether the name just read follows a unit and `*` or `/`, so that it may have been meant as a unit too.
    fn continues_unit(&self) -> bool {
        let before = |back: usize| self.at.checked_sub(back).and_then(|at| self.tokens.get(at)).map(|token| token.kind);
        matches!(before(2), Some(Kind::Symbol("*" | "/")))
            && matches!(before(3), Some(Kind::Name(unit)) if !self.names.contains(unit) && Unit::find(unit).is_some())
    }

    fn call(&mut self, name: &str, offset: usize) -> Result<Type> {
        if self.names.reduces(name)
            && let Kind::Name(argument) = self.tokens.get(self.at + 1).map_or(Kind::End, |token| token.kind)
        {
            match self.tokens.get(self.at + 2).map(|token| token.kind) {
                Some(Kind::Symbol(")")) if !self.names.needs_time(name) => {
                    self.at += 3;
                    return self.reduction(name, argument, None, offset);
                }
                Some(Kind::Symbol(",")) if self.names.needs_time(name) => {
                    self.at += 3;
                    let time = self.constant(Dimension::TIME, &format!("the time in {name}(probe, time)"))?;
                    self.expect(")")?;
                    return self.reduction(name, argument, Some(time), offset);
                }
                _ => {}
            }
        }
        self.expect("(")?;
        let start = self.code.len();
        let mut arguments = vec![self.expression(0)?];
        while self.peek().kind == Kind::Symbol(",") {
            self.at += 1;
            arguments.push(self.expression(0)?);
            // min(a, b, c) is min(min(a, b), c): folded as they come, so that the stack stays low
            if let Some(operator) = folding(name)
                && let [.., a, b] = arguments[..]
            {
                let common = self.rules.binary(operator, a, b, offset)?;
                self.code.push(Op::Binary(operator));
                arguments = vec![common];
                if self.peek().kind != Kind::Symbol(",") {
                    self.expect(")")?;
                    return Ok(common);
                }
            }
        }
        self.expect(")")?;
        match arguments[..] {
            _ if self.names.reduces(name) => {
                let error = ExpressionError::new(offset, format!("{name}() reduces the history of one probe"));
                let time = if self.names.needs_time(name) { ", 1 ms" } else { "" };
                let usage = format!("{name}(load{time})");
                Err(error.remedy(format!("write it as {usage}; a probe of its own may hold an expression")))
            }
            [a] if let Some(function) = find::<Unary>(name) => {
                if matches!(function, Unary::Sin | Unary::Cos | Unary::Tan) && a == Type::BARE {
                    refuse_degrees(name, &self.code[start..], offset)?;
                }
                self.code.push(Op::Unary(function));
                self.rules.unary(function, a, offset)
            }
            [a, b] if let Some(operator) = find::<Binary>(name) => {
                let kind = self.rules.binary(operator, a, b, offset)?;
                self.code.push(Op::Binary(operator));
                Ok(kind)
            }
            [condition, a, b] if name == "if" => {
                if condition != Type::Truth {
                    let message = format!("if() needs a condition first, not {}", condition.phrase());
                    return Err(ExpressionError::new(offset, message));
                }
                self.code.push(Op::Select);
                self.rules.common(a, b, offset)
            }
            _ => Err(wrong_call(name, arguments.len(), offset)),
        }
    }

    fn reduction(&mut self, function: &str, name: &str, at: Option<f64>, offset: usize) -> Result<Type> {
        if !self.names.contains(name) {
            return Err(self.unknown(name, offset));
        }
        let named = self.names.reduce(function, name, at).map_err(|message| ExpressionError::new(offset, message))?;
        self.code.push(named.op);
        Ok(named.kind)
    }

    /// Compiles an argument that must be a constant, and takes it out of the code again.
    fn constant(&mut self, dimension: Dimension, what: &str) -> Result<f64> {
        let offset = self.peek().offset;
        let start = self.code.len();
        let kind = self.expression(0)?;
        let value = Program::new(self.code.split_off(start)).and_then(|program| program.constant());
        match value.filter(|value| value.is_finite() && kind.fits(dimension, false)) {
            Some(value) => Ok(value),
            None => Err(ExpressionError::new(offset, format!("{what} must be {}", dimension.expected()))),
        }
    }
}

/// The function of this name; operators, whose names are symbols, are none.
fn find<T: Choice>(name: &str) -> Option<T> {
    T::NAMES.iter().find(|(known, _)| *known == name).map(|(_, function)| *function)
}

/// A number without a unit that is no angle in radians: `sin(30)`.
fn refuse_degrees(name: &str, argument: &[Op], offset: usize) -> Result<()> {
    if argument.contains(&Op::Constant(std::f64::consts::PI)) {
        return Ok(());
    }
    match Program::new(argument.to_vec()).and_then(|program| program.constant()) {
        Some(angle) if angle.abs() > std::f64::consts::TAU * (1.0 + 1e-9) => {
            let error = ExpressionError::new(offset, format!("{name}() of {angle} radians, which is more than a turn"));
            Err(error.remedy(format!("write {name}({angle} deg), or {name}({angle} rad) where radians are meant")))
        }
        _ => Ok(()),
    }
}

fn folding(name: &str) -> Option<Binary> {
    matches!(name, "min" | "max").then(|| find(name)).flatten()
}

/// Every function an expression may call, reductions aside.
pub(crate) fn functions() -> impl Iterator<Item = &'static str> {
    let unary = Unary::NAMES.iter().map(|(name, _)| *name);
    let binary = Binary::NAMES.iter().map(|(name, _)| *name);
    unary.chain(binary).chain(["if"]).filter(|name| name.starts_with(char::is_alphabetic))
}

fn wrong_call(name: &str, arguments: usize, offset: usize) -> ExpressionError {
    if functions().any(|function| function == name) {
        let plural = if arguments == 1 { "" } else { "s" };
        return ExpressionError::new(offset, format!("{name}() does not take {arguments} argument{plural}"));
    }
    let error = ExpressionError::new(offset, format!("unknown function \"{name}\""));
    match nearest(name, functions()) {
        Some(near) => error.remedy(format!("did you mean {near}()?")),
        None => error.remedy(format!("functions: {}", functions().collect::<Vec<_>>().join(", "))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expression::{Named, Op};

    /// x [m], t [s], E [Pa], f a pure number without unit.
    struct Some4;

    impl Names for Some4 {
        fn contains(&self, name: &str) -> bool {
            self.all().iter().any(|known| known == name)
        }

        fn is_variable(&self, name: &str) -> bool {
            name == "x" || name == "t"
        }

        fn find(&mut self, name: &str) -> Option<Result<Named, String>> {
            let dimension = [Dimension::LENGTH, Dimension::TIME, Dimension::PRESSURE, Dimension::NONE];
            let index = self.all().iter().position(|known| known == name)?;
            let kind = if name == "f" { Type::BARE } else { Type::number(dimension[index]) };
            Some(Ok(Named { op: Op::Input(index as u16), kind }))
        }

        fn all(&self) -> Vec<String> {
            ["x", "t", "E", "f"].map(String::from).to_vec()
        }
    }

    const INPUTS: [f64; 4] = [0.3, 0.01, 2e9, 1.5];

    fn value(text: &str) -> f64 {
        let compiled = compile(text, &mut Some4, false).unwrap_or_else(|error| panic!("{text}: {error:?}"));
        compiled.program.evaluate(&INPUTS)
    }

    fn dimension(text: &str) -> Type {
        compile(text, &mut Some4, false).unwrap_or_else(|error| panic!("{text}: {error:?}")).kind
    }

    fn message(text: &str) -> String {
        let error = compile(text, &mut Some4, false).expect_err(text);
        assert!(error.offset <= text.len());
        error.message
    }

    #[test]
    fn operators_bind_as_in_textbooks() {
        for (text, expected) in [
            ("1 + 2*3", 7.0),
            ("(1 + 2)*3", 9.0),
            ("2 - 3 - 4", -5.0),
            ("16/4/2", 2.0),
            ("-2^2", -4.0),
            ("2^-1", 0.5),
            ("2^3^2", 512.0),
            ("2^2*3", 12.0),
            ("--3", 3.0),
            ("min(3, 1, 2) + max(1, 2)", 3.0),
            ("if(x > 0.2 && t < 1 ms || f == 1.5, 10, 20)", 10.0),
            ("if(!(x > 0.2), 10, 20)", 20.0),
            ("x²", 0.09),
            ("sin(pi/6)", 0.5),
            ("sign(-3 mm) + sign(0)", -1.0),
            ("atan2(1 m, 1 m)*180/pi", 45.0),
            ("hypot(3, 4) + abs(-2) + floor(1.7) + sqrt(16) + exp(0) + log(1) + log10(100)", 15.0),
        ] {
            assert!((value(text) - expected).abs() < 1e-14, "{text} = {}", value(text));
        }
    }

    #[test]
    fn a_number_and_its_unit_are_one_quantity() {
        assert_eq!(value("21 GPa"), 21e9);
        assert_eq!(value("1 mm/us"), 1000.0);
        assert_eq!(value("50 1/ms"), 50e3);
        let pulse = 100e6 * (-0.01f64 / 0.005).exp();
        assert!((value("100 MPa*exp(-t/5 ms)") / pulse - 1.0).abs() < 1e-14);
        assert_eq!(dimension("100 MPa*exp(-t/5 ms)"), Type::number(Dimension::PRESSURE));
        assert_eq!(dimension("3 m/t"), Type::number(Dimension::VELOCITY), "t is the time here, not a tonne");
        assert_eq!(dimension("3 m/h"), Type::number(Dimension::VELOCITY), "h is the hour");
        assert_eq!(dimension("1 kg*9.81 m/s^2"), Type::number(Dimension::FORCE));
        assert_eq!(dimension("2 m^2"), Type::number(Dimension::AREA));
        assert_eq!(dimension("(2 m)^2"), Type::number(Dimension::AREA));
    }

    #[test]
    fn numbers_without_unit_are_si_in_sums_and_pure_in_products() {
        assert!(dimension("x + 0.1").fits(Dimension::LENGTH, false));
        assert!(dimension("min(x, 0.1)").fits(Dimension::LENGTH, false));
        assert!(dimension("2*x").fits(Dimension::LENGTH, false));
        assert!(dimension("3.5").fits(Dimension::DENSITY, false));
        assert!(dimension("f*2").fits(Dimension::DENSITY, false));
        assert!(!dimension("x/0.1").fits(Dimension::NONE, false));
        assert!(dimension("x/0.1").fits(Dimension::NONE, true), "0.1 may have been 0.1 m");
        assert!(!dimension("x*x").fits(Dimension::LENGTH, true));
        assert!(compile("E + 2*x", &mut Some4, false).is_err());
        assert!(compile("E + 2*x", &mut Some4, true).is_ok());
    }

    #[test]
    fn dimensions_are_checked() {
        assert_eq!(message("x + t"), "a length and a time cannot be added or compared");
        assert_eq!(message("x < 3 ms"), "a length and a time cannot be added or compared");
        assert_eq!(message("exp(t)"), "exp() of a time");
        assert_eq!(message("E*sin(30)"), "sin() of 30 radians, which is more than a turn");
        assert_eq!(message("cos(-360/2)"), "cos() of -180 radians, which is more than a turn");
        let found = value("sin(30 deg) + cos(10 rad) - sin(6) + cos(9*pi) - tan(200*x/1 m)");
        assert!((found - (0.5 + 10f64.cos() - 6f64.sin() - 1.0 - 60f64.tan())).abs() < 1e-9, "{found}");
        assert_eq!(message("2^x"), "an exponent must be a pure number, not a length");
        assert_eq!(message("x^f"), "a length can be raised to a constant power only");
        assert_eq!(message("x^0.3"), "the units of this have no meaning");
        assert_eq!(message("if(x, 1, 2)"), "if() needs a condition first, not a length");
        assert_eq!(message("x && t"), "\"&&\" needs conditions on both sides");
        assert_eq!(message("(x < 1) + 2"), "a condition and a number without a unit cannot be added or compared");
        assert_eq!(message("-(x < 1)"), "a sign needs a number, not a condition");
        assert_eq!(dimension("sqrt(E*x)*sqrt(E*x)"), Type::number(Dimension::FORCE.over(Dimension::LENGTH).unwrap()));
    }

    #[test]
    fn mistakes_are_named() {
        for (text, expected) in [
            ("", "the expression ends too early"),
            ("3 +", "the expression ends too early"),
            ("3 kgg", "\"kgg\" is not a unit"),
            ("(3", "expected \")\""),
            ("3)", "\")\" without \"(\""),
            ("x t", "expected an operator such as \"*\""),
            ("foo*2", "unknown name \"foo\""),
            ("sine(2)", "unknown function \"sine\""),
            ("sin(1, 2)", "sin() does not take 2 arguments"),
            ("max(1)", "max() does not take 1 argument"),
            ("0 < x < 1", "comparisons cannot be chained"),
            ("+(1)(2)", "expected an operator such as \"*\""),
            ("1e300 Ym", "the number is too large"),
            ("* 2", "unexpected \"*\""),
        ] {
            assert_eq!(message(text), expected, "{text}");
        }
        let remedy = |text: &str| compile(text, &mut Some4, false).expect_err(text).remedy;
        assert_eq!(remedy("3 kg/m3"), "did you mean \"m^3\"?");
        assert_eq!(remedy("3*mm"), "a unit stands right behind its number, as in 2 mm");
        assert_eq!(remedy("3*foo"), "names here: x, t, E, f, pi");
        assert_eq!(message(&"(".repeat(100_000)), "the expression is nested too deeply");
        assert_eq!(message(&format!("{}1{}", "1+(".repeat(39), ")".repeat(39))), "the expression is nested too deeply");
        assert_eq!(message(&"-".repeat(100_000)), "the expression is nested too deeply");
        assert_eq!(value(&["1"; 10_000].join("+")), 10_000.0, "long is not deep");
    }
}
