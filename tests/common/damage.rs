//! Damaged files, and runs read to their last file.

use std::path::Path;

use pbif::run::{RunError, RunSummary, StoredRun, check_folder};
use pbif::sweep_file::Report;

use super::numbers::Numbers;

/// What stands in tables for numbers, and in JSON for values, that no run writes.
#[rustfmt::skip]
const STRANGE: [&str; 12] = [
    "1e999", "-1e308", "NaN", "inf", "", "99999999999999999999", "-1", "null", "[[[[", "\"", "π", "0x1p3",
];

/// A file with bytes flipped, cut, doubled or emptied, or with a number that no run has.
pub(crate) fn damaged(whole: &[u8], numbers: &mut Numbers) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    let place = numbers.below(bytes.len());
    match numbers.below(8) {
        0 if !bytes.is_empty() => bytes[place] ^= 1 << numbers.below(8),
        1 => bytes.truncate(place),
        2 => bytes.extend_from_slice(whole),
        3 => bytes.extend_from_slice(&whole[place..]),
        4 => bytes.clear(),
        5 => {
            // A number of a text by something else.
            let is_digit = |byte: &u8| byte.is_ascii_digit();
            if let Some(start) = whole[place..].iter().position(is_digit) {
                let start = place + start;
                let length = whole[start..]
                    .iter()
                    .take_while(|byte| is_digit(byte))
                    .count();
                let strange = STRANGE[numbers.below(STRANGE.len())];
                bytes.splice(start..start + length, strange.bytes());
            }
        }
        6 => {
            // A line twice, or away.
            let lines: Vec<&[u8]> = whole.split_inclusive(|&byte| byte == b'\n').collect();
            let line = numbers.below(lines.len());
            let times = 2 * numbers.below(2);
            let kept = lines.iter().enumerate();
            bytes = kept
                .flat_map(|(index, text)| vec![*text; if index == line { times } else { 1 }])
                .flatten()
                .copied()
                .collect();
        }
        _ => {
            for _ in 0..8 {
                let place = numbers.below(bytes.len());
                if let Some(byte) = bytes.get_mut(place) {
                    *byte = numbers.next() as u8;
                }
            }
        }
    }
    bytes
}

/// Reads all there is to read of a run; what is refused names a file, or a place in one.
pub(crate) fn read_all(run: &Path) -> bool {
    let mut whole = true;
    let mut refused = |error: Option<RunError>| {
        if let Some(error) = error {
            assert!(error.to_string().len() < 20_000, "{error}");
            whole = false;
        }
    };
    refused(check_folder(run).err());
    refused(RunSummary::read(run).err());
    match StoredRun::open(run) {
        Err(error) => refused(Some(error)),
        Ok(stored) => {
            let settings = stored.sweep_file().validate();
            match settings.and_then(|settings| settings.fixed()) {
                Err(report) => {
                    assert!(Report::render(&report, false).len() < 60_000);
                    whole = false;
                }
                Ok(sweep) => {
                    refused(stored.detect(&sweep).err());
                    refused(stored.damage().err());
                }
            }
        }
    }
    whole
}
