//! Random formulas and random damage to them, the same for every run.

pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let word = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        word ^ (word >> 31)
    }

    pub(crate) fn below(&mut self, limit: usize) -> usize {
        (self.word() >> 33) as usize % limit.max(1)
    }

    pub(crate) fn unit(&mut self) -> f64 {
        (self.word() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn pick<'a>(&mut self, of: &[&'a str]) -> &'a str {
        of[self.below(of.len())]
    }

    /// A formula that the library accepts, of about so many operations.
    pub(crate) fn formula(&mut self, size: usize) -> String {
        if size == 0 {
            return self.leaf();
        }
        let left = self.below(size);
        let right = size - 1 - left;
        match self.below(20) {
            0..=3 => {
                let (a, b) = (self.formula(left), self.formula(right));
                let sign = self.pick(&["+", "-", " + ", " − "]);
                format!("{a}{sign}({b})")
            }
            4..=6 => {
                let (a, b) = (self.formula(left), self.formula(right));
                let sign = self.pick(&["*", "·", "/", " × ", ""]);
                format!("({a}){sign}({b})")
            }
            7 => format!("-({})", self.formula(size - 1)),
            8 | 9 => {
                let exponent = self.pick(&[
                    "2", "3", "-1", "4", "0.5", "1.5", "7", "-2", "0", "1", "a", "f_c",
                ]);
                format!("({})^{exponent}", self.formula(size - 1))
            }
            10 => format!(
                "({}){}",
                self.formula(size - 1),
                self.pick(&["²", "³", "⁻¹", "⁵"])
            ),
            11..=14 => {
                let name = self.pick(&[
                    "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp",
                    "log", "ln", "log10", "sqrt", "cbrt", "abs", "sign", "sgn", "step", "floor",
                ]);
                format!("{name}({})", self.formula(size - 1))
            }
            15 => {
                let name = self.pick(&["min", "max", "hypot", "atan2", "pow"]);
                format!("{name}({}, {})", self.formula(left), self.formula(right))
            }
            16 => {
                let sign = self.pick(&["<", "<=", ">", ">=", "==", "!=", "≤"]);
                format!(
                    "if({} {sign} {}, {}, {})",
                    self.formula(left / 2),
                    self.leaf(),
                    self.formula(right),
                    self.leaf()
                )
            }
            17 => {
                let sign = self.pick(&["<", ">", "≥"]);
                format!("({} {sign} {})", self.formula(left), self.formula(right))
            }
            18 => self.polynomial(),
            _ => format!("{} + {}", self.formula(left), self.formula(right)),
        }
    }

    fn polynomial(&mut self) -> String {
        let base = self.pick(&["x", "y", "(x - y)", "x y"]);
        let mut terms: Vec<String> = Vec::new();
        for power in 0..2 + self.below(5) {
            let coefficient = self.pick(&["a", "c0", "2", "β", "0.1"]);
            let base = if base.len() > 1 {
                format!("({base})")
            } else {
                base.to_owned()
            };
            terms.push(format!("{coefficient} {base}^{power}"));
        }
        let sign = self.pick(&[" + ", " - "]);
        terms.join(sign)
    }

    fn leaf(&mut self) -> String {
        match self.below(8) {
            0..=3 => self.pick(&["x", "y", "z"]).to_owned(),
            4 | 5 => self
                .pick(&[
                    "a", "β", "beta", "c₀", "c0", "c_0", "f_c", "t", "H", "pi", "π", "e",
                ])
                .to_owned(),
            6 => self
                .pick(&["0", "1", "2", "0.5", ".25", "1e-3", "3", "10", "1e2"])
                .to_owned(),
            _ => format!(
                "{} {}",
                self.pick(&["2", "0.1", "a"]),
                self.pick(&["x", "y"])
            ),
        }
    }

    /// The text with a few characters changed.
    pub(crate) fn damaged(&mut self, text: &str, other: &str) -> String {
        let mut characters: Vec<char> = text.chars().collect();
        for _ in 0..1 + self.below(2) {
            let at = self.below(characters.len() + 1);
            let spare: Vec<char> = "xyzaβt()()**/+-−·²³ ,.0192e<π\tH_\0=é".chars().collect();
            match self.below(6) {
                0 if at < characters.len() => drop(characters.remove(at)),
                1 if at + 1 < characters.len() => characters.swap(at, at + 1),
                2 => {
                    let piece: Vec<char> = other.chars().collect();
                    let start = self.below(piece.len());
                    let end = (start + 1 + self.below(8)).min(piece.len());
                    characters.splice(at..at, piece[start.min(end)..end].iter().copied());
                }
                3 if at < characters.len() => characters[at] = spare[self.below(spare.len())],
                _ => characters.insert(at, spare[self.below(spare.len())]),
            }
        }
        characters.into_iter().collect()
    }

    /// Anything at all.
    pub(crate) fn garbage(&mut self) -> String {
        let words = [
            "x", "y", "sin", "(", ")", "^", "*", "/", "-", "+", " ", ",", "2", ".", "1e", "e",
            "if", "²", "⁻", "₀", "<", "==", "=", "pow(", "\0", "\u{202e}", "𝛼", "é", "_", "1e400",
            "0x1F", "NaN", "inf", "t", "π", "\r\n",
        ];
        (0..self.below(30)).map(|_| self.pick(&words)).collect()
    }
}
