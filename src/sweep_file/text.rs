//! The text of a sweep file: read no further than a sweep file can reach, and told from what is no text.

use std::io::Read as _;
use std::path::{Path, PathBuf};

use super::diagnostic::{Diagnostic, Place, Sources};
use super::names::nearest_name;
use super::report::Report;

/// Largest sweep file, in bytes. The shipped ones have about a thousand.
pub(super) const MOST_BYTES: usize = 1_000_000;

/// A sweep file word for word, as a person typed it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct SweepText {
    /// Path of the file as it was given.
    pub(crate) file: String,
    /// Its text.
    pub(crate) text: String,
    /// What was set on top of it, each as `KEY=VALUE`, in their order.
    pub(crate) set: Vec<String>,
}

/// A text, or the beginning of one that is too long.
#[derive(Debug, PartialEq)]
pub(super) struct Text {
    /// Whole lines.
    pub(super) text: String,
    /// Whether more follows.
    pub(super) is_cut: bool,
}

impl Text {
    /// The beginning of a text, up to the end of the last line that fits.
    pub(super) fn beginning(text: &str) -> Self {
        let is_cut = text.len() > MOST_BYTES;
        let bytes = &text.as_bytes()[..text.len().min(MOST_BYTES)];
        let end = if is_cut {
            end_of_lines(bytes)
        } else {
            text.len()
        };
        Self {
            text: text[..end].to_owned(),
            is_cut,
        }
    }
}

/// Where the last line of these bytes ends; zero where none does.
fn end_of_lines(bytes: &[u8]) -> usize {
    let newline = bytes.iter().rposition(|&byte| byte == b'\n');
    newline.map_or(0, |newline| newline + 1)
}

/// What is said of a text that is too long.
pub(super) fn too_large(name: &str) -> Diagnostic {
    Diagnostic::new(format!(
        "the sweep file `{name}` is larger than {} MB, and was read no further",
        MOST_BYTES / 1_000_000
    ))
    .remedy("a sweep file holds some fifty keys: check the path; tables of data and long comments belong elsewhere")
}

/// Reads a file, at most [`MOST_BYTES`] of it.
///
/// # Errors
/// A report when it cannot be read, or is not text in UTF-8.
pub(super) fn read(file: &Path) -> Result<Text, Report> {
    let name = file.display().to_string();
    let mut bytes = Vec::new();
    let opened = std::fs::File::open(file);
    let read = opened.and_then(|opened| {
        opened
            .take(MOST_BYTES as u64 + 1)
            .read_to_end(&mut bytes)
            .map(drop)
    });
    read.map_err(|error| {
        let title = match file.read_link() {
            Ok(target) if error.kind() == std::io::ErrorKind::NotFound => {
                let target = target.display();
                format!("the sweep file `{name}` is a link that leads nowhere, to `{target}`")
            }
            _ => format!("cannot read the sweep file `{name}`: {error}"),
        };
        let remedy = match nearest_file(file) {
            Some(near) => format!("did you mean `{}`?", near.display()),
            None => "check the path; `sweeps/` holds examples".to_owned(),
        };
        Diagnostic::new(title).remedy(remedy)
    })?;
    let is_cut = bytes.len() > MOST_BYTES;
    if is_cut {
        bytes.truncate(end_of_lines(&bytes[..MOST_BYTES]));
    }
    if bytes.is_empty() && is_cut {
        return Err(too_large(&name).into());
    }
    if is_utf16(&bytes) {
        let title = format!("the sweep file `{name}` is text in UTF-16, not UTF-8");
        return Err(Diagnostic::new(title)
            .remedy("save it as UTF-8: most editors offer the encoding under \"Save as\"")
            .into());
    }
    match String::from_utf8(bytes) {
        Ok(text) => Ok(Text { text, is_cut }),
        Err(error) => Err(not_utf8(
            &name,
            error.as_bytes(),
            error.utf8_error().valid_up_to(),
        )),
    }
}

/// The sweep file beside one that is not there whose name is nearest, or the one of that name in `sweeps/`.
fn nearest_file(file: &Path) -> Option<PathBuf> {
    /// A folder with more entries than these is no folder of sweep files.
    const MOST_ENTRIES: usize = 1000;
    let name = file.file_name()?.to_str()?;
    let folder = file.parent()?;
    let looked_in = match folder.as_os_str().is_empty() {
        true => Path::new("."),
        false => folder,
    };
    let entries = std::fs::read_dir(looked_in).into_iter().flatten().flatten();
    let names = entries.take(MOST_ENTRIES);
    let names = names.filter_map(|entry| entry.file_name().into_string().ok());
    let names: Vec<String> = names.filter(|name| name.ends_with(".toml")).collect();
    let sweeps = Path::new("sweeps").join(name);
    match nearest_name(name, names.iter().map(String::as_str)) {
        Some(near) if near != name => Some(folder.join(near)),
        None if sweeps.is_file() => Some(sweeps),
        _ => None,
    }
}

/// Whether bytes begin with the mark of UTF-16, or every other one is zero, as of ASCII in UTF-16.
fn is_utf16(bytes: &[u8]) -> bool {
    let beginning = &bytes[..bytes.len().min(512)];
    let zeros = beginning.iter().filter(|&&byte| byte == 0).count();
    bytes.starts_with(&[0xff, 0xfe])
        || bytes.starts_with(&[0xfe, 0xff])
        || 4 * zeros > beginning.len()
}

/// What is said of bytes of which the one at `start` begins no character.
fn not_utf8(name: &str, bytes: &[u8], start: usize) -> Report {
    let beginning = &bytes[..bytes.len().min(512)];
    let is_control = |byte: &u8| *byte < 32 && !b"\t\n\r\x0c".contains(byte);
    if beginning.iter().any(is_control) {
        let title = format!("the sweep file `{name}` is not UTF-8, nor any other text");
        return Diagnostic::new(title)
            .remedy("check the path; `sweeps/` holds examples")
            .into();
    }
    let byte = bytes.get(start).copied().unwrap_or_default();
    let mut sources = Sources::default();
    // Up to the place, the text is the same.
    let source = sources.add(name, &String::from_utf8_lossy(bytes));
    let place = Place {
        source,
        span: start..start + char::REPLACEMENT_CHARACTER.len_utf8(),
    };
    let title = format!("the sweep file `{name}` is not UTF-8 text");
    let diagnostic = Diagnostic::new(title)
        .at(&place, format!("byte 0x{byte:02x} begins no character"))
        .remedy("save it as UTF-8 (it may be Latin-1), or write the word without this character");
    Report::new(sources, vec![diagnostic], 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(bytes: &[u8]) -> String {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.toml");
        std::fs::write(&file, bytes).unwrap();
        read(&file).unwrap_err().to_string()
    }

    #[test]
    fn other_encodings_are_told_apart() {
        let utf16: Vec<u8> = "title = 1"
            .encode_utf16()
            .flat_map(u16::to_le_bytes)
            .collect();
        let with_mark = [&[0xff, 0xfe], utf16.as_slice()].concat();
        for utf16 in [&with_mark, &utf16] {
            assert!(refusal(utf16).contains("UTF-16, not UTF-8"));
        }
        let text = refusal(b"a = 1\ntitle = \"caf\xe9\"\n");
        assert!(
            text.contains("a.toml:2:13") && text.contains("0xe9"),
            "{text}"
        );
        assert!(refusal(b"\x89PNG\r\n\x1a\n").contains("nor any other text"));
    }

    #[cfg(unix)]
    #[test]
    fn a_file_without_end_is_not_read_to_its_end() {
        let text = read(Path::new("/dev/zero")).unwrap_err().to_string();
        assert!(text.contains("larger than 1 MB"), "{text}");
    }

    #[test]
    fn long_texts_are_cut_at_a_line() {
        let line = "# a comment\n";
        let long = line.repeat(MOST_BYTES / line.len() + 1);
        let cut = Text::beginning(&long);
        assert!(cut.is_cut && cut.text.len() < MOST_BYTES && cut.text.ends_with("comment\n"));
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.toml");
        std::fs::write(&file, &long).unwrap();
        assert_eq!(read(&file).unwrap(), cut);
        assert!(!Text::beginning(&long[..MOST_BYTES]).is_cut);
    }
}
