//! The page as one file: its sources put together, its data in blocks. It refers to nothing outside itself, and its
//! content security policy lets it run its own script and nothing else.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest as _, Sha256};

const FRAME: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/page.css");

/// The parts of the script in the order in which they need each other.
const SCRIPT: [&str; 21] = [
    include_str!("page/unpack.js"),
    include_str!("page/numbers.js"),
    include_str!("page/colours.js"),
    include_str!("page/pens.js"),
    include_str!("page/contours.js"),
    include_str!("page/plots.js"),
    include_str!("page/data.js"),
    include_str!("page/panels.js"),
    include_str!("page/along.js"),
    include_str!("page/words.js"),
    include_str!("page/plane.js"),
    include_str!("page/state.js"),
    include_str!("page/page.js"),
    include_str!("page/controls.js"),
    include_str!("page/phases.js"),
    include_str!("page/mapped.js"),
    include_str!("page/asking.js"),
    include_str!("page/paths.js"),
    include_str!("page/live.js"),
    include_str!("page/editor.js"),
    include_str!("page/start.js"),
];

/// The page with this title, this deflated scene and these blocks of packed values. A live one may ask the server that
/// sent it.
pub(super) fn page(title: &str, scene: &[u8], blocks: &[Vec<u8>], live: bool) -> String {
    let script = format!("(() => {{\n\"use strict\";\n{}}})();\n", SCRIPT.concat());
    let policy = format!(
        "default-src 'none'; script-src '{}'; style-src '{}'; img-src data: blob:; connect-src {}; base-uri 'none'; form-action 'none'",
        hash(&script),
        hash(STYLE),
        if live { "'self'" } else { "'none'" }
    );
    let title = escape(title);
    let mut data = block("scene", scene);
    for (number, bytes) in blocks.iter().enumerate() {
        data += &block(&format!("block-{number}"), bytes);
    }
    // What is filled in is searched for in the frame alone, never in what was filled in before.
    let mut html = String::with_capacity(data.len() + script.len() + STYLE.len() + FRAME.len());
    for piece in FRAME.split_inclusive("-->") {
        let (before, mark) = match piece.rfind("<!--") {
            Some(at) => piece.split_at(at),
            None => (piece, ""),
        };
        html += before;
        html += match mark {
            "<!--policy-->" => &policy,
            "<!--title-->" => &title,
            "<!--style-->" => STYLE,
            "<!--data-->" => &data,
            "<!--script-->" => &script,
            other => other,
        };
    }
    html
}

/// What a content security policy calls a script or style that it lets run.
fn hash(text: &str) -> String {
    format!(
        "sha256-{}",
        STANDARD.encode(Sha256::digest(text.as_bytes()))
    )
}

/// Bytes in a script that no browser runs.
fn block(id: &str, bytes: &[u8]) -> String {
    let text = STANDARD.encode(bytes);
    format!("<script type=\"application/octet-stream\" id=\"{id}\">{text}</script>\n")
}

fn escape(text: &str) -> String {
    let letter = |c: char| match c {
        '&' => "&amp;".to_owned(),
        '<' => "&lt;".to_owned(),
        '>' => "&gt;".to_owned(),
        '"' => "&quot;".to_owned(),
        c => c.to_string(),
    };
    text.chars().map(letter).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_refers_to_nothing_outside_itself() {
        let page = page("A title", b"scene", &[b"first".to_vec()], false);
        // Names of namespaces are no references.
        let text = ["2000/svg", "1998/Math/MathML"]
            .iter()
            .fold(page.clone(), |text, name| {
                text.replace(&format!("http://www.w3.org/{name}"), "")
            });
        for outside in [
            "http:", "https:", "src=", "@import", "url(", "<link", "//cdn", "import(",
        ] {
            let found: Vec<&str> = text.lines().filter(|line| line.contains(outside)).collect();
            let own = |line: &&str| line.contains("url(#");
            assert!(found.iter().all(own), "{outside}: {found:?}");
        }
        assert!(page.starts_with(crate::PAGE));
        assert_eq!(page.matches("<!doctype html>").count(), 1);
        assert!(page.contains("id=\"block-0\">Zmlyc3Q=<"));
        assert!(!page.contains("<!--"));
    }

    #[test]
    fn the_policy_lets_this_script_run_and_no_other() {
        let page = page("A title", b"", &[], true);
        let policy = page.split("content=\"default-src").nth(1).unwrap();
        let policy = policy.split('"').next().unwrap();
        assert!(
            policy.starts_with(" 'none';") && !policy.contains("unsafe"),
            "{policy}"
        );
        let script = page
            .split("<script>")
            .nth(1)
            .unwrap()
            .split("</script>")
            .next()
            .unwrap();
        let style = page
            .split("<style>")
            .nth(1)
            .unwrap()
            .split("</style>")
            .next()
            .unwrap();
        assert!(policy.contains(&hash(script)) && policy.contains(&hash(style)));
        // Handlers and styles within tags would be refused by it.
        let words = || FRAME.split_whitespace();
        assert!(words().all(|word| !word.starts_with("style=")));
        assert!(words().all(|word| !(word.starts_with("on") && word.contains('='))));
    }

    #[test]
    fn a_title_is_text_whatever_it_holds() {
        let title = "</title><script>alert(1)</script><!--data--> & \"x\"";
        let page = page(title, b"scene", &[], false);
        assert!(!page.contains("alert(1)</script>"));
        assert_eq!(page.matches("id=\"scene\"").count(), 1);
        assert!(page.contains("&lt;!--data--&gt; &amp; &quot;x&quot;"));
    }
}
