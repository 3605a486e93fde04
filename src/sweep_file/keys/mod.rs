//! The keys of a sweep file. Each is declared once, in [`table`]: reading, writing, messages about unknown keys, the
//! long help and `docs/sweep-file.md` are all made from there.
//!
//! Defaults that a program option has are those of its `Default`, got as the value of a file that says nothing.

mod field;
mod in_file;
mod kind;
mod table;
#[cfg(test)]
mod tests;

pub(super) use field::{Field, end_of, nearest_bound};
pub(super) use kind::{Kind, models};
pub(super) use table::KEYS;

use super::draft::{Draft, MethodKind};

/// What holds when a key is left out.
#[derive(Debug, Clone, Copy)]
pub(super) enum KeyDefault {
    /// It must be given.
    Required,
    /// The value that the program's options have by themselves.
    OfOptions,
    /// The value that the options of its section have by themselves.
    OfSection(fn() -> String),
    /// A rule in words.
    Rule(&'static str),
}

/// One key of a sweep file.
#[derive(Debug, Clone, Copy)]
pub struct Key {
    path: &'static str,
    pub(super) kind: Kind,
    pub(super) default: KeyDefault,
    pub(super) field: Field,
    meaning: &'static str,
}

/// Every key, in the order in which a file is best read.
pub fn keys() -> &'static [Key] {
    KEYS
}

impl Key {
    /// Path with dots; `<…>` stands for a name of the model.
    pub fn path(&self) -> &'static str {
        self.path
    }

    /// What is allowed, in words.
    pub(crate) fn allowed(&self) -> String {
        self.kind.words()
    }

    /// Meaning in words; the methods that it concerns stand first, where it does not concern all.
    pub(crate) fn meaning(&self) -> String {
        match self.methods().as_slice() {
            methods if methods.len() == MethodKind::ALL.len() => self.meaning.to_owned(),
            methods => {
                let names: Vec<&str> = methods.iter().map(|method| method.name()).collect();
                format!("{}: {}", names.join(", "), self.meaning)
            }
        }
    }

    /// What holds when it is left out, in words.
    pub(crate) fn default_words(&self) -> String {
        match self.default {
            KeyDefault::Required => "required".to_owned(),
            KeyDefault::OfOptions => self.option_words(),
            KeyDefault::OfSection(value) => format!("`{}`", value()),
            KeyDefault::Rule(words) => words.to_owned(),
        }
    }

    /// The defaults of the options, by method where they differ.
    fn option_words(&self) -> String {
        let methods = self.methods();
        let defaults: Vec<String> = methods
            .iter()
            .filter_map(|&method| Some(format!("`{}`", self.untouched(method)?)))
            .collect();
        match defaults.as_slice() {
            [first, rest @ ..] if rest.iter().all(|other| other == first) => first.clone(),
            all => {
                let each = all.iter().zip(&methods);
                let each = each.map(|(value, method)| format!("{value} by {}", method.name()));
                each.collect::<Vec<_>>().join(", ")
            }
        }
    }

    /// The methods that the key concerns.
    fn methods(&self) -> Vec<MethodKind> {
        let concerns = |method: &MethodKind| {
            // Only options of methods are known to be there before a file says anything.
            !matches!(self.default, KeyDefault::OfOptions) || self.untouched(*method).is_some()
        };
        MethodKind::ALL.into_iter().filter(concerns).collect()
    }

    /// The value as TOML where a file says nothing but its method.
    fn untouched(&self, method: MethodKind) -> Option<String> {
        let mut draft = Draft::default();
        if self.path != "method.kind" {
            draft.method.kind = method;
        }
        (self.field.get)(&draft, "").map(|plain| plain.to_toml())
    }

    /// The parts of the path.
    pub(super) fn parts(&self) -> impl Iterator<Item = &'static str> {
        self.path.split('.')
    }

    /// Whether the path begins with these names; a part `<…>` matches every name.
    pub(super) fn starts_with(&self, names: &[&str]) -> bool {
        let mut parts = self.parts();
        names.iter().all(|name| {
            parts
                .next()
                .is_some_and(|part| part == *name || is_stand_in(part))
        })
    }

    /// Whether the path is this one.
    pub(super) fn matches(&self, names: &[&str]) -> bool {
        self.parts().count() == names.len() && self.starts_with(names)
    }

    /// The name of a path that a part `<…>` stands for, several joined by points; empty where there is none.
    pub(super) fn name_in(&self, names: &[&str]) -> String {
        let pairs = self.parts().zip(names);
        let stand_ins = pairs.filter(|(part, _)| is_stand_in(part));
        let names: Vec<&str> = stand_ins.map(|(_, name)| *name).collect();
        names.join(".")
    }
}

/// Whether a part of a path stands for a name of the model.
pub(super) fn is_stand_in(part: &str) -> bool {
    part.starts_with('<')
}

/// The key at a path.
pub(super) fn find(names: &[&str]) -> Option<&'static Key> {
    KEYS.iter().find(|key| key.matches(names))
}

/// The key that has this name in a table where names such as `<axis>` are keys too.
pub(super) fn by_name(stand_in: &str, name: &str) -> Option<&'static Key> {
    KEYS.iter().find(|key| {
        let at = key.parts().position(|part| part == name);
        at.is_some_and(|at| {
            let beside = |other: &Key| {
                other.parts().nth(at) == Some(stand_in)
                    && other.parts().take(at).eq(key.parts().take(at))
            };
            KEYS.iter().any(beside)
        })
    })
}

/// The keys for the long help of the commands that read a sweep file.
pub fn help() -> String {
    let mut text = "Keys of a sweep file (--set KEY=VALUE overrides any of them):\n".to_owned();
    for key in KEYS {
        let (path, meaning, words) = (key.path, key.meaning(), key.allowed());
        let default = match key.default {
            KeyDefault::Required => key.default_words(),
            _ => format!("default: {}", key.default_words()),
        };
        text += &format!("\n  {path}\n      {meaning}\n      {words}; {default}\n");
    }
    text.replace('`', "")
}
