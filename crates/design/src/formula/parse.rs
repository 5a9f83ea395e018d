//! From words to steps: precedence parsing with a stack of its own, so that no text can exhaust the
//! program's.
//!
//! `+ −` bind least, then `* /`, then the sign, then `^`, which associates to the right: `-x^2` is −(x²),
//! `2^-1` is 1/2, `2^3^2` is 2⁹. Parentheses and functions nest at most [`DEPTH_LIMIT`] deep.

use super::error::{FormulaError, Result};
use super::program::{Formula, Function, Step};
use super::token::{Relation, Token, Word, tokens};

/// How deep parentheses may nest.
pub const DEPTH_LIMIT: usize = 200;

/// Whole powers up to this size are computed by multiplication.
const WHOLE_POWER: f64 = 64.0;

/// What waits for its right-hand side.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Waiting {
    Binary(Step),
    Sign,
    Parenthesis {
        column: usize,
    },
    Call {
        function: Function,
        name: &'static str,
        column: usize,
        given: usize,
        open: usize,
    },
}

impl Waiting {
    fn precedence(self) -> u8 {
        match self {
            Self::Binary(Step::Add | Step::Subtract) => 1,
            Self::Binary(Step::Multiply | Step::Divide) => 2,
            Self::Sign => 3,
            Self::Binary(_) => 4,
            Self::Parenthesis { .. } | Self::Call { .. } => 0,
        }
    }
}

/// The meaning of a name.
pub trait Names {
    /// The number of the variable of this name.
    fn variable(&self, name: &str) -> Option<usize>;
    /// A name that was probably meant.
    fn meant(&self, name: &str) -> Option<String>;
}

/// Reads a formula.
pub(crate) fn formula(text: &str, names: &impl Names) -> Result<Formula> {
    let (list, end) = tokens(text)?;
    parse(&list, end, names)
}

/// Reads a constraint: its sides and how they relate.
pub(crate) fn constraint(text: &str, names: &impl Names) -> Result<(Formula, Relation, Formula)> {
    let (list, end) = tokens(text)?;
    let relations: Vec<(usize, Relation)> = list
        .iter()
        .enumerate()
        .filter_map(|(place, token)| match token.word {
            Word::Relation(relation) => Some((place, relation)),
            _ => None,
        })
        .collect();
    let [(place, relation)] = relations.as_slice() else {
        return Err(FormulaError::Relations {
            column: relations
                .get(1)
                .map_or(end, |(place, _)| list[*place].column),
            given: relations.len(),
        });
    };
    let left = parse(&list[..*place], list[*place].column, names)?;
    let right = parse(&list[place + 1..], end, names)?;
    Ok((left, *relation, right))
}

struct Parser {
    steps: Vec<Step>,
    waiting: Vec<Waiting>,
    depth: usize,
}

fn parse(list: &[Token<'_>], end: usize, names: &impl Names) -> Result<Formula> {
    let mut parser = Parser {
        steps: Vec::with_capacity(list.len()),
        waiting: Vec::new(),
        depth: 0,
    };
    let mut words = list.iter().peekable();
    // Does a number, a name or a sign come next, rather than an operator?
    let mut operand = true;
    while let Some(token) = words.next() {
        if operand {
            operand = match &token.word {
                Word::Number(value) => {
                    parser.steps.push(Step::Constant(*value));
                    false
                }
                Word::Name(name) => {
                    let called = matches!(words.peek(), Some(next) if next.word == Word::Open);
                    if called {
                        let open = words.next().map_or(token.column, |open| open.column);
                        parser.open_call(name, token.column, open)?;
                    } else {
                        parser.name(name, token.column, names)?;
                    }
                    called
                }
                Word::Minus => {
                    parser.waiting.push(Waiting::Sign);
                    true
                }
                Word::Plus => true,
                Word::Open => {
                    parser.deeper(token.column)?;
                    let column = token.column;
                    parser.waiting.push(Waiting::Parenthesis { column });
                    true
                }
                _ => return Err(unexpected(token, "a number, a name or `(`")),
            };
        } else {
            operand = match &token.word {
                Word::Plus => parser.operator(Step::Add),
                Word::Minus => parser.operator(Step::Subtract),
                Word::Times => parser.operator(Step::Multiply),
                Word::Divide => parser.operator(Step::Divide),
                Word::Power => parser.operator(Step::Power),
                Word::Comma => parser.comma(token)?,
                Word::Close => parser.close(token)?,
                _ => return Err(unexpected(token, "an operator")),
            };
        }
    }
    if operand {
        return Err(FormulaError::Unexpected {
            column: end,
            found: "the end".to_owned(),
            expected: "a number, a name or `(`",
        });
    }
    parser.reduce(0);
    match parser.waiting.pop() {
        Some(Waiting::Parenthesis { column } | Waiting::Call { open: column, .. }) => {
            Err(FormulaError::Unclosed { column })
        }
        _ => Ok(Formula {
            steps: parser.steps,
        }),
    }
}

fn unexpected(token: &Token<'_>, expected: &'static str) -> FormulaError {
    FormulaError::Unexpected {
        column: token.column,
        found: token.shown(),
        expected,
    }
}

impl Parser {
    fn deeper(&mut self, column: usize) -> Result<()> {
        self.depth += 1;
        if self.depth > DEPTH_LIMIT {
            let limit = DEPTH_LIMIT;
            return Err(FormulaError::TooDeep { column, limit });
        }
        Ok(())
    }

    fn name(&mut self, name: &str, column: usize, names: &impl Names) -> Result<()> {
        let step = match names.variable(name) {
            Some(index) => Step::Variable(index),
            None if name == "pi" => Step::Constant(std::f64::consts::PI),
            None => {
                return Err(FormulaError::UnknownName {
                    column,
                    name: name.chars().take(64).collect(),
                    meant: names.meant(name),
                });
            }
        };
        self.steps.push(step);
        Ok(())
    }

    fn open_call(&mut self, name: &str, column: usize, open: usize) -> Result<()> {
        self.deeper(open)?;
        let Some((name, function)) = Function::ALL.iter().find(|(known, _)| *known == name) else {
            return Err(FormulaError::UnknownFunction {
                column,
                name: name.chars().take(64).collect(),
                meant: grouser_files::nearest(name, Function::ALL.iter().map(|(known, _)| *known))
                    .map(str::to_owned),
            });
        };
        self.waiting.push(Waiting::Call {
            function: *function,
            name,
            column,
            given: 1,
            open,
        });
        Ok(())
    }

    /// Writes out everything that binds at least as tightly as `precedence`.
    fn reduce(&mut self, precedence: u8) {
        while let Some(&top) = self.waiting.last() {
            if top.precedence() < precedence.max(1) {
                return;
            }
            self.waiting.pop();
            match top {
                Waiting::Sign => self.steps.push(Step::Negate),
                Waiting::Binary(Step::Power) => self.power(),
                Waiting::Binary(step) => self.steps.push(step),
                Waiting::Parenthesis { .. } | Waiting::Call { .. } => {}
            }
        }
    }

    fn power(&mut self) {
        let whole = |n: f64| n.fract() == 0.0 && n.abs() <= WHOLE_POWER;
        let step = match self.steps.as_slice() {
            [.., Step::Constant(n)] if whole(*n) => Some((1, *n)),
            [.., Step::Constant(n), Step::Negate] if whole(*n) => Some((2, -*n)),
            _ => None,
        };
        match step {
            #[allow(
                clippy::cast_possible_truncation,
                reason = "a whole number of at most 64"
            )]
            Some((length, n)) => {
                self.steps.truncate(self.steps.len() - length);
                self.steps.push(Step::WholePower(n as i32));
            }
            None => self.steps.push(Step::Power),
        }
    }

    /// A binary operator: an operand must follow.
    fn operator(&mut self, step: Step) -> bool {
        let own = Waiting::Binary(step);
        // To the right: an equal one on the left waits.
        let associates_right = step == Step::Power;
        self.reduce(own.precedence() + u8::from(associates_right));
        self.waiting.push(own);
        true
    }

    /// The next argument: an operand must follow.
    fn comma(&mut self, token: &Token<'_>) -> Result<bool> {
        self.reduce(0);
        match self.waiting.last_mut() {
            Some(Waiting::Call { given, .. }) => {
                *given += 1;
                Ok(true)
            }
            _ => Err(unexpected(token, "an operator")),
        }
    }

    /// A closing parenthesis: an operator must follow.
    fn close(&mut self, token: &Token<'_>) -> Result<bool> {
        self.reduce(0);
        match self.waiting.pop() {
            Some(Waiting::Parenthesis { .. }) => {}
            Some(Waiting::Call {
                function,
                name,
                column,
                given,
                ..
            }) => {
                let (least, most, expected) = function.arguments();
                if given < least || given > most {
                    return Err(FormulaError::Arguments {
                        column,
                        name,
                        given,
                        expected,
                    });
                }
                self.steps.push(Step::Call(function, given));
            }
            _ => return Err(unexpected(token, "an operator")),
        }
        self.depth -= 1;
        Ok(false)
    }
}
