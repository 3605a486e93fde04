//! Words of choices: what files, tables and messages call the variants of an enum.

/// Gives an enum `ALL`, its variants in their order, and a function with the word of each.
macro_rules! words {
    ($of:ident, $seen:vis $name:ident: $($variant:ident: $word:literal),+ $(,)?) => {
        impl $of {
            /// All of them, in the order of files and tables.
            $seen const ALL: [Self; [$($word),+].len()] = [$(Self::$variant),+];

            /// The word used in files and tables.
            $seen const fn $name(self) -> &'static str {
                match self {
                    $(Self::$variant => $word),+
                }
            }
        }
    };
}
