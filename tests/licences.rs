//! Every dependency has a licence that `deny.toml` allows, and comes from the registry. Nothing is fetched for it.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

/// Strings between the quotes of a text.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('"').skip(1).step_by(2)
}

/// What `deny.toml` allows, and the licences that it knows of packages without one.
fn rules() -> (BTreeSet<String>, BTreeMap<String, String>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("deny.toml");
    let text = std::fs::read_to_string(path).unwrap();
    let list = text.split_once("allow = [").unwrap().1.split_once(']').unwrap().0;
    let value = |line: &str, key: &str| Some(quoted(line.strip_prefix(key)?).next()?.to_owned());
    let mut known = BTreeMap::new();
    for part in text.split("[[licenses.clarify]]").skip(1) {
        let name = part.lines().find_map(|line| value(line, "crate = ")).unwrap();
        known.insert(name, part.lines().find_map(|line| value(line, "expression = ")).unwrap());
    }
    (quoted(list).map(str::to_owned).collect(), known)
}

/// Whether an SPDX expression can be kept by what is allowed.
fn is_allowed(expression: &str, allowed: &BTreeSet<String>) -> bool {
    let text = expression.replace('/', " OR ").replace('(', " ( ").replace(')', " ) ").replace(" WITH ", "+WITH+");
    let words: Vec<&str> = text.split_whitespace().collect();
    let mut rest = words.as_slice();
    any_of(&mut rest, allowed) && rest.is_empty()
}

fn any_of(words: &mut &[&str], allowed: &BTreeSet<String>) -> bool {
    let mut holds = all_of(words, allowed);
    while let ["OR", rest @ ..] = *words {
        *words = rest;
        holds |= all_of(words, allowed);
    }
    holds
}

fn all_of(words: &mut &[&str], allowed: &BTreeSet<String>) -> bool {
    let mut holds = one(words, allowed);
    while let ["AND", rest @ ..] = *words {
        *words = rest;
        holds &= one(words, allowed);
    }
    holds
}

fn one(words: &mut &[&str], allowed: &BTreeSet<String>) -> bool {
    match *words {
        ["(", rest @ ..] => {
            *words = rest;
            let holds = any_of(words, allowed);
            *words = words.get(1..).unwrap_or_default();
            holds
        }
        [name, rest @ ..] => {
            *words = rest;
            allowed.contains(&name.replace("+WITH+", " WITH "))
        }
        [] => false,
    }
}

/// What `cargo metadata` says of the packages that are built here.
fn metadata() -> Value {
    let mut command = Command::new(env!("CARGO"));
    command.args(["metadata", "--format-version", "1", "--offline", "--locked", "--filter-platform", &host()]);
    if cfg!(feature = "train") {
        command.args(["--features", "train"]);
    }
    let output = command.current_dir(env!("CARGO_MANIFEST_DIR")).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The target triple of this machine.
fn host() -> String {
    let output = Command::new(env!("CARGO")).args(["--version", "--verbose"]).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines().find_map(|line| line.strip_prefix("host: ")).unwrap().to_owned()
}

#[test]
fn every_dependency_has_an_allowed_licence_and_comes_from_the_registry() {
    let (allowed, known) = rules();
    let metadata = metadata();
    let nodes = metadata["resolve"]["nodes"].as_array().unwrap();
    let built: BTreeSet<&str> = nodes.iter().filter_map(|node| node["id"].as_str()).collect();
    let packages = metadata["packages"].as_array().unwrap();
    let mut wrong = Vec::new();
    for package in packages.iter().filter(|p| built.contains(p["id"].as_str().unwrap())) {
        let name = package["name"].as_str().unwrap();
        let licence = package["license"].as_str().or(known.get(name).map(String::as_str)).unwrap_or("none");
        if !is_allowed(licence, &allowed) {
            wrong.push(format!("{name}: {licence}"));
        }
        let source = package["source"].as_str();
        if !source.map_or(name.starts_with("fieldtrace"), |source| source.starts_with("registry+")) {
            wrong.push(format!("{name} comes from {source:?}"));
        }
    }
    assert!(built.len() > 100 && wrong.is_empty(), "of {} packages: {wrong:#?}", built.len());
}

#[test]
fn expressions_are_read_as_meant() {
    let allowed: BTreeSet<String> = ["MIT", "ISC", "Apache-2.0 WITH LLVM-exception"].map(str::to_owned).into();
    for yes in
        ["MIT", "GPL-3.0 OR MIT", "MIT/GPL-3.0", "(MIT OR GPL-3.0) AND ISC", "Apache-2.0 WITH LLVM-exception AND MIT"]
    {
        assert!(is_allowed(yes, &allowed), "{yes}");
    }
    for no in [
        "",
        "GPL-3.0",
        "MIT AND GPL-3.0",
        "(GPL-3.0 AND MIT) OR GPL-2.0",
        "Apache-2.0",
        "MIT MIT",
        "GPL-3.0 OR (MIT AND GPL-3.0)",
    ] {
        assert!(!is_allowed(no, &allowed), "{no}");
    }
}
