//! `ro-crate-metadata.json`: the run described in the words of RO-Crate (Process Run Crate 0.5), which archives and
//! catalogues of research data read: what was run, by which program, when, from what, and which files it left. It is
//! made from `run.json`.

use std::path::Path;

use serde_json::{Value, json};

use super::RunError;
use super::atomic::write_atomically;

/// Name of the file, which the format prescribes.
pub(super) const NAME: &str = "ro-crate-metadata.json";

/// Files and folders of a run that are described, each with what it is and its media type; those that are not there are
/// left out.
const PARTS: [(&str, &str, &str); 11] = [
    (
        "run.json",
        "Manifest: program, resolved sweep, seed, how the run ended",
        "application/json",
    ),
    (
        "points.csv",
        "A row a parameter value: status, residual, moments, counts of peaks and craters",
        "text/csv",
    ),
    ("features.csv", "A row a peak, valley or crater", "text/csv"),
    (
        "bifurcations.csv",
        "Located P-bifurcations with their errors",
        "text/csv",
    ),
    (
        "bifurcations.json",
        "Located P-bifurcations with their errors",
        "application/json",
    ),
    (
        "bifurcations.md",
        "Located P-bifurcations with their errors",
        "text/markdown",
    ),
    (
        "bifurcations.tex",
        "Located P-bifurcations with their errors",
        "application/x-tex",
    ),
    (
        "checks.csv",
        "Indicators seen on the finer grid that checks located values",
        "text/csv",
    ),
    (
        "closer_looks.json",
        "P-bifurcations found on finer cells where the sweep's left them in doubt",
        "application/json",
    ),
    (
        "densities.zarr/",
        "All stationary densities with their errors, as a Zarr store",
        "",
    ),
    ("figures/", "Figures of the run", ""),
];

/// Writes the description of an ended run from its manifest.
///
/// # Errors
/// [`RunError::Read`], [`RunError::Manifest`] or [`RunError::Write`].
pub(super) fn write(run: &Path) -> Result<(), RunError> {
    let file = run.join("run.json");
    let bytes = super::place::read(&file).map_err(RunError::reading(&file))?;
    let manifest: Value = serde_json::from_slice(&bytes).map_err(|error| RunError::Manifest {
        path: file,
        message: error.to_string(),
    })?;
    let there = PARTS
        .into_iter()
        .filter(|(name, ..)| run.join(name).exists());
    let crate_of_run = describe(&manifest, &there.collect::<Vec<_>>());
    let text = serde_json::to_string_pretty(&crate_of_run)? + "\n";
    write_atomically(&run.join(NAME), text.as_bytes())
}

/// The metadata of a run with these parts.
fn describe(manifest: &Value, parts: &[(&str, &str, &str)]) -> Value {
    let id = |id: &str| json!({ "@id": id });
    let ids = |names: &mut dyn Iterator<Item = &str>| names.map(id).collect::<Vec<_>>();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let (made, sweep) = (&manifest["made"], &manifest["sweep"]);
    let title = text(&sweep["title"]);
    let parameter = text(&sweep["sweep"]["parameter"]);
    let started = text(&made["started"]);
    let ended = made["ended"].as_str().unwrap_or(&started);
    let complete = manifest["ending"] == "complete";
    let status = if complete { "Completed" } else { "Failed" };
    let mut action = json!({
        "@id": "#run",
        "@type": "CreateAction",
        "name": format!("pbif sweep along {parameter}"),
        "instrument": id("#pbif"),
        "object": [id("#sweep")],
        "result": ids(&mut parts.iter().map(|part| part.0)),
        "startTime": started,
        "endTime": ended,
        "actionStatus": { "@id": format!("http://schema.org/{status}ActionStatus") },
    });
    if !complete {
        action["error"] = json!("stopped before its end; `pbif sweep` with `--resume` goes on");
    }
    let mut program = json!({
        "@id": "#pbif",
        "@type": "SoftwareApplication",
        "name": "pbif",
        "description": env!("CARGO_PKG_DESCRIPTION"),
        "softwareVersion": manifest["version"],
        "operatingSystem": made["system"],
        "processorRequirements": made["architecture"],
    });
    if let Some(commit) = made["commit"].as_str() {
        program["identifier"] = json!(format!("git:{commit}"));
    }
    let mut graph = vec![
        json!({
            "@id": NAME,
            "@type": "CreativeWork",
            "conformsTo": id("https://w3id.org/ro/crate/1.1"),
            "about": id("./"),
        }),
        json!({
            "@id": "./",
            "@type": "Dataset",
            "name": title,
            "description": format!("Stationary densities and stochastic P-bifurcations along {parameter}: {title}"),
            "datePublished": ended,
            "conformsTo": id("https://w3id.org/ro/wfrun/process/0.5"),
            "hasPart": ids(&mut parts.iter().map(|part| part.0)),
            "mentions": id("#run"),
        }),
        json!({
            "@id": "https://w3id.org/ro/wfrun/process/0.5",
            "@type": "CreativeWork",
            "name": "Process Run Crate",
            "version": "0.5",
        }),
        action,
        program,
        json!({
            "@id": "#sweep",
            "@type": "CreativeWork",
            "name": "Sweep file, every key filled in",
            "encodingFormat": "application/toml",
            "sha256": manifest["hash"],
            "text": manifest["sweep_file"],
        }),
    ];
    graph.extend(parts.iter().map(|(name, words, kind)| {
        if name.ends_with('/') {
            return json!({ "@id": name, "@type": "Dataset", "name": words });
        }
        json!({ "@id": name, "@type": "File", "name": words, "encodingFormat": kind })
    }));
    json!({
        "@context": [
            "https://w3id.org/ro/crate/1.1/context",
            "https://w3id.org/ro/terms/workflow-run/context",
        ],
        "@graph": graph,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_crate_names_its_parts_and_what_made_them() {
        let folder = tempfile::tempdir().unwrap();
        let run = folder.path();
        let manifest = json!({
            "version": "0.1.0", "hash": "ab", "sweep_file": "title = \"T\"\n", "ending": "complete",
            "sweep": { "title": "T", "sweep": { "parameter": "f_c" } },
            "made": { "started": "2026-01-01T00:00:00Z", "ended": "2026-01-01T00:01:00Z", "commit": "abc-dirty", "system": "linux" },
        });
        std::fs::write(run.join("run.json"), manifest.to_string()).unwrap();
        std::fs::write(run.join("points.csv"), "a\n").unwrap();
        std::fs::create_dir(run.join("figures")).unwrap();
        write(run).unwrap();
        let text = std::fs::read_to_string(run.join(NAME)).unwrap();
        let metadata: Value = serde_json::from_str(&text).unwrap();
        let graph = metadata["@graph"].as_array().unwrap();
        let entity = |id: &str| graph.iter().find(|one| one["@id"] == id).unwrap();
        // Every reference leads to an entity of the graph, or to the web.
        let mut open = vec![&metadata["@graph"]];
        while let Some(value) = open.pop() {
            match value {
                Value::Array(all) => open.extend(all),
                Value::Object(all) => {
                    if let (1, Some(id)) = (all.len(), all.get("@id").and_then(Value::as_str)) {
                        let outside = id.starts_with("http");
                        assert!(outside || graph.iter().any(|one| one["@id"] == id), "{id}");
                    }
                    open.extend(all.values());
                }
                _ => {}
            }
        }
        let parts: Vec<_> = entity("./")["hasPart"].as_array().unwrap().clone();
        assert_eq!(
            parts,
            ["run.json", "points.csv", "figures/"].map(|name| json!({ "@id": name }))
        );
        assert_eq!(entity("#run")["endTime"], "2026-01-01T00:01:00Z");
        assert_eq!(entity("#pbif")["identifier"], "git:abc-dirty");
        assert_eq!(entity("#sweep")["text"], "title = \"T\"\n");
        assert_eq!(entity("figures/")["@type"], "Dataset");
    }
}
