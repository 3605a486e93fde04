//! What a file asks of the relaxation to the steady state.

use crate::sweep_file::diagnostic::Diagnostic;
use crate::sweep_file::draft::{Draft, MethodKind};
use crate::sweep_file::reader::Reader;

/// How many slow modes are wanted; 0 for none. They are eigenvalues of the generator, which the other methods do not
/// have.
pub(super) fn read(reader: &mut Reader<'_>, draft: &Draft) -> usize {
    let Some(wanted) = draft.slow_modes else {
        return 0;
    };
    if draft.method.kind != MethodKind::Generator {
        let name = draft.method.kind.name();
        let title = format!("slow modes are worked out by `generator`, not by `{name}`");
        let remedy = "set `method.kind = \"generator\"`, or leave `[relaxation]` out";
        let diagnostic = Diagnostic::new(title).remedy(remedy);
        let entry = reader.entry(&["relaxation", "modes"]);
        reader.report(match entry {
            Some(entry) => diagnostic.at(&entry.key_place, "this number"),
            None => diagnostic,
        });
    }
    wanted
}
