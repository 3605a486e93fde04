//! A second reader of the language, as plain as it can be: recursive descent over characters to boxed trees. It accepts
//! some texts that the library refuses; it is asked only about those that the library accepts.

/// A formula as a tree.
#[derive(Debug, Clone)]
pub(crate) enum Tree {
    Number(f64),
    Name(String),
    Negate(Box<Tree>),
    Binary(&'static str, Box<Tree>, Box<Tree>),
    Call(String, Vec<Tree>),
}

pub(crate) fn read(text: &str) -> Option<Tree> {
    let mut reader = Reader {
        text: text.chars().collect(),
        at: 0,
    };
    let tree = reader.comparison()?;
    reader.blank();
    (reader.at == reader.text.len()).then_some(tree)
}

struct Reader {
    text: Vec<char>,
    at: usize,
}

const RAISED: &str = "⁰¹²³⁴⁵⁶⁷⁸⁹";
const LOWERED: &str = "₀₁₂₃₄₅₆₇₈₉";

fn is_letter(c: char) -> bool {
    c.is_ascii_alphabetic()
        || ('α'..='ω').contains(&c)
        || ('Α'..='Ω').contains(&c)
        || "µϕϵϑϰϱϖΩ".contains(c)
}

impl Reader {
    fn blank(&mut self) {
        while self.text.get(self.at).is_some_and(|c| c.is_whitespace()) {
            self.at += 1;
        }
    }

    fn peek(&mut self) -> Option<char> {
        self.blank();
        self.text.get(self.at).copied()
    }

    /// The operator that stands next, longest first.
    fn operator(&mut self, known: &[(&str, &'static str)]) -> Option<&'static str> {
        self.blank();
        for (written, name) in known {
            let characters: Vec<char> = written.chars().collect();
            if self.text[self.at..].starts_with(&characters) {
                self.at += characters.len();
                return Some(name);
            }
        }
        None
    }

    fn comparison(&mut self) -> Option<Tree> {
        let left = self.sum()?;
        let known = [
            ("<=", "<="),
            ("≤", "<="),
            (">=", ">="),
            ("≥", ">="),
            ("==", "=="),
            ("!=", "!="),
            ("≠", "!="),
            ("<", "<"),
            (">", ">"),
        ];
        match self.operator(&known) {
            Some(operator) => Some(Tree::Binary(
                operator,
                Box::new(left),
                Box::new(self.sum()?),
            )),
            None => Some(left),
        }
    }

    fn sum(&mut self) -> Option<Tree> {
        let mut left = self.product()?;
        while let Some(operator) = self.operator(&[("+", "+"), ("-", "-"), ("−", "-")]) {
            left = Tree::Binary(operator, Box::new(left), Box::new(self.product()?));
        }
        Some(left)
    }

    fn product(&mut self) -> Option<Tree> {
        let mut left = self.signed()?;
        loop {
            let known = [("*", "*"), ("·", "*"), ("⋅", "*"), ("×", "*"), ("/", "/")];
            if let Some(operator) = self.operator(&known) {
                left = Tree::Binary(operator, Box::new(left), Box::new(self.signed()?));
            } else if self.peek().is_some_and(|c| c == '(' || is_letter(c)) {
                left = Tree::Binary("*", Box::new(left), Box::new(self.power()?));
            } else {
                return Some(left);
            }
        }
    }

    fn signed(&mut self) -> Option<Tree> {
        match self.operator(&[("+", "+"), ("-", "-"), ("−", "-")]) {
            Some("-") => Some(Tree::Negate(Box::new(self.signed()?))),
            Some(_) => self.signed(),
            None => self.power(),
        }
    }

    fn power(&mut self) -> Option<Tree> {
        let mut base = self.atom()?;
        if let Some(exponent) = self.raised() {
            base = Tree::Binary("^", Box::new(base), Box::new(Tree::Number(exponent)));
        }
        match self.operator(&[("^", "^")]) {
            Some(_) => Some(Tree::Binary(
                "^",
                Box::new(base),
                Box::new(self.exponent()?),
            )),
            None => Some(base),
        }
    }

    fn exponent(&mut self) -> Option<Tree> {
        match self.operator(&[("+", "+"), ("-", "-"), ("−", "-")]) {
            Some("-") => Some(Tree::Negate(Box::new(self.exponent()?))),
            Some(_) => self.exponent(),
            None => self.power(),
        }
    }

    fn raised(&mut self) -> Option<f64> {
        self.blank();
        let (start, mut value) = (self.at, 0.0);
        let minus = self.text.get(self.at) == Some(&'⁻');
        self.at += usize::from(minus);
        while let Some(digit) = self
            .text
            .get(self.at)
            .and_then(|c| RAISED.chars().position(|r| r == *c))
        {
            value = 10.0 * value + digit as f64;
            self.at += 1;
        }
        (self.at > start).then_some(if minus { -value } else { value })
    }

    fn atom(&mut self) -> Option<Tree> {
        let next = self.peek()?;
        if next == '(' {
            self.at += 1;
            let inner = self.comparison()?;
            self.operator(&[(")", ")")])?;
            Some(inner)
        } else if next.is_ascii_digit() || next == '.' {
            self.number()
        } else if is_letter(next) {
            self.name_or_call()
        } else {
            None
        }
    }

    fn number(&mut self) -> Option<Tree> {
        let digits = |at: usize| {
            self.text[at..]
                .iter()
                .take_while(|c| c.is_ascii_digit())
                .count()
        };
        let start = self.at;
        let mut end = start + digits(start);
        if self.text.get(end) == Some(&'.') {
            end += 1 + digits(end + 1);
        }
        if matches!(self.text.get(end), Some('e' | 'E')) {
            let sign = usize::from(matches!(self.text.get(end + 1), Some('+' | '-' | '−')));
            let exponent = digits((end + 1 + sign).min(self.text.len()));
            if exponent > 0 {
                end += 1 + sign + exponent;
            }
        }
        let written: String = self.text[start..end].iter().collect();
        self.at = end;
        written.replace('−', "-").parse().ok().map(Tree::Number)
    }

    fn name_or_call(&mut self) -> Option<Tree> {
        let start = self.at;
        let part = |c: char| is_letter(c) || c.is_ascii_digit() || c == '_' || LOWERED.contains(c);
        while self.text.get(self.at).copied().is_some_and(part) {
            self.at += 1;
        }
        let name: String = self.text[start..self.at].iter().collect();
        if !super::evaluate::is_function(&name) {
            return Some(Tree::Name(name));
        }
        self.operator(&[("(", "(")])?;
        let mut arguments = vec![self.comparison()?];
        while self.operator(&[(",", ",")]).is_some() {
            arguments.push(self.comparison()?);
        }
        self.operator(&[(")", ")")])?;
        Some(Tree::Call(name, arguments))
    }
}
