//! Thousands of changed sweep files: each is read or refused, and none panics.

use crate::common::numbers::Numbers;
use crate::common::room::shipped;

/// Pieces that sweep files are made of, and some that they are not.
#[rustfmt::skip]
const PIECES: [&str; 24] = [
    "1e308", "-1", "nan", "inf", "0", "1e-320", "99999999999999999999", "\"\"", "[]", "{}", "= ", "[[", "]]", "\n[cells]\n",
    "\nmodel = \"dahl\"\n", "\"auto\"", "x", "sigma2", "((((", "sqrt(", "^", "\u{3b1}", "\u{0}", "'''",
];

/// A text with a few things changed in it: pieces put in, characters lost, lines doubled, lost or exchanged, the end
/// cut off.
fn changed(text: &str, numbers: &mut Numbers) -> String {
    let mut letters: Vec<char> = text.chars().collect();
    for _ in 0..=numbers.below(3) {
        let place = numbers.below(letters.len() + 1).min(letters.len());
        let end = (place + numbers.below(12)).min(letters.len());
        match numbers.below(6) {
            0 => drop(letters.splice(place..end, PIECES[numbers.below(PIECES.len())].chars())),
            1 => drop(letters.splice(place..place, PIECES[numbers.below(PIECES.len())].chars())),
            2 => drop(letters.drain(place..end)),
            3 => letters.truncate(letters.len() - numbers.below(letters.len() / 2 + 1)),
            _ => {
                let whole: String = letters.iter().collect();
                let mut lines: Vec<&str> = whole.lines().collect();
                let (one, other) = (numbers.below(lines.len()), numbers.below(lines.len()));
                match numbers.below(3) {
                    _ if lines.is_empty() => {}
                    0 => lines.swap(one, other),
                    1 => lines.insert(one, lines[other]),
                    _ => drop(lines.remove(one)),
                }
                letters = (lines.join("\n") + "\n").chars().collect();
            }
        }
    }
    letters.into_iter().collect()
}

#[test]
fn five_thousand_changed_sweep_files_are_read_or_refused_and_never_panic() {
    let mut texts = vec![super::bad_input::GOOD.to_owned()];
    for folder in ["sweeps", "sweeps/gallery"] {
        let entries = std::fs::read_dir(shipped(folder)).unwrap();
        let mut files: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
        files.sort();
        files.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
        texts.extend(
            files
                .into_iter()
                .map(|path| std::fs::read_to_string(path).unwrap()),
        );
    }
    let mut numbers = Numbers(0x9e37_79b9_7f4a_7c15);
    let (mut read, mut refused) = (0, 0);
    for case in 0..5000 {
        let text = changed(&texts[case % texts.len()], &mut numbers);
        match pbif::sweep_file::SweepFile::parse("a.toml", &text).validate() {
            Ok(_) => read += 1,
            Err(report) => {
                // What is wrong is said, in a bounded number of words.
                let words = report.render(false);
                assert!(!words.is_empty() && words.len() < 60_000, "{text}\n{words}");
                refused += 1;
            }
        }
    }
    assert!(
        read > 200 && refused > 2000,
        "{read} read, {refused} refused"
    );
}
