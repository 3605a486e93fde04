//! The spelling of pages, comments and the texts of the program, without a dictionary: common misspellings, American
//! spellings, words that stand twice, and words that stand once or twice and differ by one letter from a common one.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::links::{pages, prose};

/// Beginnings of words that are never right in British English.
const WRONG: &str = "accomodat acheiv accross agressiv aquir arguement assymetr asymetr begining beleiv calender catagor \
    comming commited compatab consistan continous definat dependan diffren dissapear embarass enviroment equilibirum \
    existan explicitely familar feasab fluctation foward freqeunc gaurant goverment hieght idependen immediatly \
    independan inital intergrat knowlege lenght liason maintainance manouver momentarly neccess noticable occassion \
    occured occurence occuring oscilat paramater paralel particulary perfom persistan posess precission \
    preceed probabilty probablity procede promiss pronounciation prefered publically recieve recomend refered \
    resoluton responsability seperat sieze similiar simultanous stochatic \
    succesful successfull sufficent suprise symetr thier threshhold throught tolerence transiton \
    truely untill useable usefull verfi visable wich wierd writting yeild teh adn hte taht \
    behavior favorab favorit neighbor color center gray analyz catalyz paralyz modeled modeling labeled labeling traveled \
    traveling canceled canceling fulfill honor labor harbor vapor";

/// Words that end as American ones do, or begin as wrong ones do, and are right: the method is called generalized,
/// titles of papers are colored, and pages of the explorer have attributes.
const RIGHT: &str = "size sized sizes resize resized capsize capsizes capsizing prize seize seized assize usize isize \
    laborious laboratory honorary grayscale \
    generalized colored color autocapitalize";

/// Words that are one letter from a common one, and are meant.
const MEANT: &str = "accented banded billionth binding binned contrast decade deflection elastic forked formed frictions \
    generalised generic handled hashes hatched having heading holmes horner joints leader leaders \
    leading leaking lowers matches notation pasted patches pionts plates raising reused sealed shines \
    sleeps slices spares spends springs stepped stuart swatches taking trails unclosed upsilon weighed \
    worded wright";

/// A word stands in few places where it stands in no more than this.
const RARE: usize = 2;
/// A word is common where it stands in as many places.
const COMMON: usize = 6;
/// Shorter words are one letter from many others.
const SHORTEST: usize = 6;

/// Pages, and what the program and its sources say, by the files in which it stands.
fn texts() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |path: &Path| std::fs::read_to_string(path).unwrap();
    let mut found: Vec<(PathBuf, String)> = Vec::new();
    for page in pages() {
        let text = prose(&read(&page));
        found.push((page, text));
    }
    let mut open = vec![
        root.join("src"),
        root.join("sweeps"),
        root.join("python/src"),
    ];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let kind = path
                .extension()
                .and_then(|kind| kind.to_str())
                .unwrap_or_default();
            match kind {
                _ if path.is_dir() => open.push(path),
                "rs" | "js" | "toml" => {
                    let text = said(&read(&path), if kind == "toml" { "#" } else { "//" });
                    found.push((path, text));
                }
                "html" => found.push((path.clone(), read(&path))),
                _ => {}
            }
        }
    }
    found
}

/// Comments and texts between quotes; a mark stands where something else was.
fn said(source: &str, comment: &str) -> String {
    let mut kept = String::new();
    for line in source.lines() {
        let is_comment = line.trim_start().starts_with(comment);
        if is_comment {
            let words = line.trim_start().trim_start_matches(['/', '#', '!']);
            kept.extend(words.split('`').step_by(2).flat_map(|part| [part, "`"]));
        } else {
            kept.extend(
                line.split('"')
                    .skip(1)
                    .step_by(2)
                    .flat_map(|part| [part, "`"]),
            );
            kept.push('`');
        }
        kept.push('\n');
    }
    kept
}

/// Words of lower-case letters, the first of which may be a capital: no names of code. Where something that is no
/// space stands between two of them, an empty word does.
fn words(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for part in text.split_whitespace() {
        for piece in part.split_inclusive(|c: char| !c.is_alphabetic() && c != '\'') {
            let word: String = piece.chars().filter(|c| c.is_alphabetic()).collect();
            let rest = word.chars().skip(1);
            if word.is_ascii() && !word.is_empty() && rest.clone().all(|c| c.is_ascii_lowercase()) {
                found.push(word.to_lowercase());
            } else if !word.is_empty() {
                found.push(String::new());
            }
            if piece.chars().any(|c| !c.is_alphabetic()) {
                found.push(String::new());
            }
        }
    }
    found
}

fn listed(words: &'static str) -> impl Iterator<Item = &'static str> + Clone {
    words.split_whitespace().filter(|word| !word.contains('-'))
}

/// Whether a word is misspelt, or spelt as in America.
fn is_wrong(word: &str) -> bool {
    let endings = ["ize", "ized", "izes", "izing", "ization", "izations"];
    let is_american = word.len() > 5 && endings.iter().any(|ending| word.ends_with(ending));
    let begins = listed(WRONG).any(|beginning| match beginning.len() {
        ..4 => word == beginning,
        _ => word.starts_with(beginning),
    });
    (is_american || begins) && !listed(RIGHT).any(|right| right == word)
}

/// What differs from a word by one letter: one is missing, two are exchanged, one is another, one is too many.
fn neighbours(word: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for place in 0..=word.len() {
        let (before, after) = word.split_at(place);
        let mut rest = after.chars();
        let first = rest.next();
        let shorter = rest.as_str();
        for letter in 'a'..='z' {
            found.insert(format!("{before}{letter}{after}"));
            if first.is_some() {
                found.insert(format!("{before}{letter}{shorter}"));
            }
        }
        if let Some(first) = first {
            found.insert(format!("{before}{shorter}"));
            if let Some(second) = rest.next() {
                found.insert(format!("{before}{second}{first}{}", rest.as_str()));
            }
        }
    }
    found.remove(word);
    found
}

/// Whether two words differ by their ending or their beginning alone, as those of one family do.
fn is_of_one_family(one: &str, other: &str) -> bool {
    let least = one.len().min(other.len());
    let shared = one
        .bytes()
        .zip(other.bytes())
        .take_while(|(a, b)| a == b)
        .count();
    shared + 1 >= least || one.ends_with(other) || other.ends_with(one)
}

/// What is wrong in some texts: a word and where it stands.
fn mistakes(texts: &[(PathBuf, String)]) -> Vec<String> {
    let mut found = Vec::new();
    let mut places: BTreeMap<String, (usize, &Path)> = BTreeMap::new();
    for (path, text) in texts {
        let all = words(text);
        for (number, word) in all.iter().enumerate().filter(|(_, word)| !word.is_empty()) {
            if is_wrong(word) {
                found.push(format!("{}: {word}", path.display()));
            }
            let is_twice = number > 0 && all[number - 1] == *word && word.len() > 1;
            if is_twice && !["that", "had", "not"].contains(&word.as_str()) {
                found.push(format!("{}: {word} {word}", path.display()));
            }
            places.entry(word.clone()).or_insert((0, path)).0 += 1;
        }
    }
    let is_common = |word: &String| places.get(word).is_some_and(|(count, _)| *count >= COMMON);
    for (word, (count, path)) in &places {
        if *count > RARE || word.len() < SHORTEST || listed(MEANT).any(|meant| meant == word) {
            continue;
        }
        let near = neighbours(word).into_iter();
        let mut near = near.filter(|other| is_common(other) && !is_of_one_family(word, other));
        if let Some(other) = near.next() {
            found.push(format!("{}: {word} (or {other}?)", path.display()));
        }
    }
    found
}

#[test]
fn mistakes_are_found() {
    let of = |text: &str| mistakes(&[(PathBuf::from("page.md"), text.to_owned())]);
    let right = "The density of the noise is normal. ".repeat(COMMON);
    assert_eq!(of(&right), Vec::<String>::new());
    for (wrong, told) in [
        ("It recieves noise.", "recieves"),
        ("Its behavior changes.", "behavior"),
        ("It is normalized.", "normalized"),
        ("It is the the noise.", "the the"),
        ("It is the\nthe noise.", "the the"),
        ("The denstiy is normal.", "denstiy (or density?)"),
        ("The densty is normal.", "densty (or density?)"),
        ("It is nromal.", "nromal (or normal?)"),
        ("It is a teh word.", "teh"),
    ] {
        assert_eq!(of(&format!("{right}{wrong}")), [format!("page.md: {told}")]);
    }
    // What is code is none of it.
    let source = "let color = normalize(x);\n// A `color` of the noise.\nsay(\"its behavior\");\n";
    let found = mistakes(&[(PathBuf::from("a.rs"), said(source, "//"))]);
    assert_eq!(found, ["a.rs: behavior"]);
}

#[test]
fn pages_comments_and_texts_are_spelt_right() {
    let texts = texts();
    assert!(texts.len() > 300, "only {} texts were read", texts.len());
    let found = mistakes(&texts);
    assert!(
        found.is_empty(),
        "{} mistakes:\n{}",
        found.len(),
        found.join("\n")
    );
}
