//! The order of the modules that the documentation states is that of the code.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The names in backticks between two phrases of a text.
fn named(text: &str, from: &str, to: &str) -> Vec<String> {
    let after = &text[text.find(from).expect("the sentence begins") + from.len()..];
    let sentence = &after[..after.find(to).expect("the sentence ends")];
    sentence.split('`').skip(1).step_by(2).map(String::from).collect()
}

/// The Rust files of a module, which is a file or a folder.
fn files(of: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut left = vec![of.with_extension("rs"), of.to_owned()];
    while let Some(path) = left.pop() {
        if let Ok(entries) = fs::read_dir(&path) {
            left.extend(entries.map(|entry| entry.expect("an entry").path()));
        } else if path.is_file() && path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files
}

/// The names that code takes from a path, as `PATH::name` or `PATH::{name, ...}`; comments and unit tests aside.
fn used(text: &str, path: &str) -> BTreeSet<String> {
    let code: Vec<&str> = text.split("#[cfg(test)]").next().unwrap_or_default().lines().collect();
    let code: Vec<&str> = code.into_iter().filter(|line| !line.trim_start().starts_with("//")).collect();
    let code = code.join("\n");
    let word = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let mut names = BTreeSet::new();
    for (at, _) in code.match_indices(path) {
        let rest = &code[at + path.len()..];
        match rest.strip_prefix('{') {
            None => drop(names.insert(word(rest))),
            Some(list) => {
                let list = &list[..list.find("};").unwrap_or(list.len())];
                names.extend(list.split(',').map(|name| word(name.trim())));
            }
        }
    }
    names
}

/// Every module of a folder is in an order, and uses by some paths only those before it.
#[track_caller]
fn check(folder: &Path, order: &[String], paths: &[&str]) {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let stems = entries.filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()));
    let modules: BTreeSet<String> =
        stems.filter(|name| !["lib", "mod", "bin", "guide"].contains(&name.as_str())).collect();
    assert_eq!(modules, order.iter().cloned().collect(), "the modules of {}", folder.display());
    for (k, module) in order.iter().enumerate() {
        for file in files(&folder.join(module)) {
            let text = fs::read_to_string(&file).expect("a file");
            for name in paths.iter().flat_map(|path| used(&text, path)) {
                let place = order.iter().position(|other| *other == name);
                assert!(place.is_none_or(|at| at <= k), "{} uses {name}, which comes later", file.display());
            }
        }
    }
}

#[test]
fn a_module_uses_only_those_before_it() {
    let guide = fs::read_to_string(root().join("src/guide/how_it_works.md")).expect("the page of the guide");
    let order = named(&guide, "A module of `src` uses only those before it:", "and the binaries");
    check(&root().join("src"), &order, &["crate::"]);
}

#[test]
fn a_module_of_the_graph_uses_only_those_before_it() {
    let graph = root().join("src/graph");
    let text = fs::read_to_string(graph.join("mod.rs")).expect("the module");
    let order = named(&text, "# The order of the modules", "each uses");
    check(&graph, &order, &["crate::graph::", " super::"]);
}

#[test]
fn what_is_used_is_found() {
    let text = "use crate::{fit, graph::Line};\nuse crate::clean::Ink;\n// crate::write is not\n#[cfg(test)]\nuse crate::synth;";
    let found: Vec<String> = used(text, "crate::").into_iter().collect();
    assert_eq!(found, ["clean", "fit", "graph"]);
}
