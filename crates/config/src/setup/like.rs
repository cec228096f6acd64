//! Inheritance: what a vehicle file leaves out comes from the classes and cars that its `like` names.
//!
//! The result is one document, in which each value keeps its place in the file that has it; everything after it (checks, `show`, studies)
//! sees no difference. Tables are joined key by key. A value, a list and an option of a choice replace what is inherited as a whole, so that
//! a car with another box or another engine model has no key of the former one. `title`, `short`, `baselines` and `like` itself are not inherited.

use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};
use std::sync::OnceLock;

use super::{Kind, is_path, unknown_name, unreadable};
use crate::document::{Document, Entry, Node, Table, Value};
use crate::files::bounded::{self, ReadError};
use crate::files::{Files, embedded};
use crate::problem::place::Input;
use crate::problem::source::{Parent, Source};
use crate::reader::lists::words;
use crate::reader::unknown::is_row;
use crate::{Place, Problem, Problems, decode};
use cvtcycle_model::files::{HEAD, VEHICLE};
use cvtcycle_model::keys;

/// Marks the name of a class.
const CLASS: &str = "class:";
/// Longest chain of files that inherit from each other.
const MAX_DEPTH: usize = 8;
/// Most files that one car inherits from, counted as often as they are named.
const MAX_PARENTS: usize = 32;
/// Names of the table of the file itself, which are not inherited.
const OWN: [&str; 4] = [
    HEAD.title.name,
    HEAD.short.name,
    HEAD.baselines.name,
    HEAD.like.name,
];

/// The document of the vehicle `file` with all that it inherits; the files that it names come from `files`.
///
/// # Errors
/// Names that are not known, files that cannot be read or are no vehicle, and files that inherit from themselves.
pub(super) fn resolve(document: Document, files: &dyn Files) -> Result<Document, Problems> {
    let file = document.sources[0].input.to_string();
    Resolver::new(&file, files).resolve(document, Path::new(""))
}

/// Finds what a vehicle file names.
pub(super) struct Resolver<'f> {
    files: &'f dyn Files,
    /// Folder of the vehicle's file, from which `files` counts.
    shown: PathBuf,
    /// Names of the files from the vehicle down to the one that is read.
    chain: Vec<String>,
    /// Files so far.
    count: usize,
}

impl<'f> Resolver<'f> {
    /// For the vehicle `file`; the files that it names come from `files`.
    pub fn new(file: &str, files: &'f dyn Files) -> Self {
        let shown = Path::new(file).parent().map(Path::to_path_buf);
        Resolver {
            files,
            shown: shown.unwrap_or_default(),
            chain: vec![file.to_owned()],
            count: 0,
        }
    }

    /// A document in a folder with all that it inherits.
    fn resolve(&mut self, mut document: Document, folder: &Path) -> Result<Document, Problems> {
        let mut problems = Problems::new();
        let mut inherited = Table::default();
        for (word, place) in named(&document)? {
            let parent = self.parent(&word, folder).map_err(|found| {
                found.map(|problem| match problem.place.input {
                    Input::Argument(_) => problem.at(place.clone()).key("vehicle.like"),
                    _ => problem,
                })
            });
            let Some(parent) = problems.take(parent) else {
                continue;
            };
            let offset = document.sources.len();
            document.sources.extend(parent.sources);
            let mut later = parent.root;
            later.each_span(&|span| span.source += offset);
            if let Some(Entry {
                node:
                    Node {
                        value: Value::Table(head),
                        ..
                    },
                ..
            }) = later.entries.get_mut("vehicle")
            {
                head.entries.retain(|name| !OWN.contains(&name));
            }
            join(&mut later, inherited, "");
            inherited = later;
        }
        join(&mut document.root, inherited, "");
        problems.finish().map(|()| document)
    }

    /// A class or a car that a file in `folder` names.
    pub fn parent(&mut self, word: &str, folder: &Path) -> Result<Document, Problems> {
        let (name, text, parent) = self.source(word, folder)?;
        if let Some(at) = self.chain.iter().position(|before| *before == name) {
            let ring: Vec<&str> = self.chain[at..].iter().map(String::as_str).collect();
            let message = format!(
                "`{name}` inherits from itself: {} -> {name}",
                ring.join(" -> ")
            );
            let problem = Problem::conflict(message).hint("take one of these names out");
            return Err(refused(word, problem));
        }
        self.count += 1;
        if self.chain.len() > MAX_DEPTH || self.count > MAX_PARENTS {
            let message = "the car inherits from too many files";
            let allowed = format!("up to {MAX_DEPTH} in a row, {MAX_PARENTS} in all");
            let problem = Problem::too_large(message).allowed(allowed);
            return Err(refused(
                word,
                problem.hint("name the classes in the file itself"),
            ));
        }
        let folder = parent.folder.clone();
        let source = Source::new(Input::File(name.clone()), &text).inherited(Some(parent));
        let document = Document::from_source(source)?;
        let is_vehicle = document.root.entries.keys().any(|key| is_row(key));
        if !document.root.entries.is_empty() && !is_vehicle {
            let problem = Problem::invalid(format!("`{name}` is no vehicle file"))
                .allowed("a vehicle, or class:NAME")
                .hint("a vehicle has [road_load], [engine], [transmission], [thermal] or some of them");
            return Err(refused(word, problem));
        }
        self.chain.push(name);
        let resolved = self.resolve(document, &folder);
        self.chain.pop();
        resolved
    }

    /// Name, text and relation of what a file in `folder` names.
    fn source(&self, word: &str, folder: &Path) -> Result<(String, String, Parent), Problems> {
        let embedded = |kind: Kind, name: &str| {
            let unknown = || match Kind::Class.names().contains(&name) {
                true => unknown_name(name, kind).hint(format!("write {CLASS}{name}")),
                false => unknown_name(name, kind),
            };
            embedded::text(kind.embedded(), name).ok_or_else(unknown)
        };
        let of = |status, from: String, words, folder| Parent {
            status,
            from,
            words,
            folder,
        };
        if let Some(class) = word.strip_prefix(CLASS) {
            let text = embedded(Kind::Class, class)?;
            let from = format!("class {class}");
            let parent = of("class", from.clone(), from, PathBuf::new());
            return Ok((format!("embedded:{word}.toml"), text.to_owned(), parent));
        }
        let like = |name: &str, folder| {
            let words = format!("as {name}, not of this car");
            of("like", format!("like {name}"), words, folder)
        };
        if !is_path(word) {
            let text = embedded(Kind::Vehicle, word)?;
            let parent = like(word, PathBuf::new());
            return Ok((format!("embedded:{word}.toml"), text.to_owned(), parent));
        }
        let path = plain(&folder.join(word));
        let file = plain(&self.shown.join(&path));
        let file = file.to_string_lossy().into_owned();
        let bytes = self.files.read(&path.to_string_lossy());
        let bytes = bytes.and_then(|bytes| match bytes.len() as u64 {
            size if size > bounded::TOML.bytes => {
                Err(ReadError::TooLarge(Some(size), bounded::TOML))
            }
            _ => Ok(bytes),
        });
        let bytes = bytes.map_err(|why| unreadable(&file, Kind::Vehicle, &why))?;
        let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
        Ok((
            file.clone(),
            decode(&file, &bytes)?,
            like(&super::stem(word), folder),
        ))
    }
}

/// A problem of a name, whose place the caller knows.
fn refused(word: &str, problem: Problem) -> Problems {
    problem.at(Kind::Vehicle.argument()).value(word).into()
}

/// The names of `like` with their places.
///
/// # Errors
/// It is no text or list of texts, or is not in `[vehicle]`: with it all that it would give seems to be missing.
fn named(document: &Document) -> Result<Vec<(String, Place)>, Problem> {
    if let Some(entry) = document.root.entries.get(HEAD.like.name) {
        return Err(Problem::unknown_key("unknown key `like`")
            .at(document.place(&entry.key))
            .key(HEAD.like.name)
            .names_key()
            .hint("write it below [vehicle]"));
    }
    let Some(node) = document.root.node(&["vehicle", HEAD.like.name]) else {
        return Ok(Vec::new());
    };
    let node = node.inner();
    let texts = match &node.value {
        Value::List(items) => items.as_slice(),
        _ => std::slice::from_ref(node),
    };
    let mut names = Vec::new();
    for node in texts {
        let Value::Text(text) = &node.value else {
            let message = "`vehicle.like` names no vehicle or class";
            return Err(Problem::wrong_type(message)
                .at(document.place(&node.span))
                .key("vehicle.like")
                .names_key()
                .value(document.shown(&node.span))
                .allowed(HEAD.like.allowed())
                .hint("write like = \"rover_216_cvt\", or like = [\"class:compact_2020\", \"class:box_cvt_clutch\"]"));
        };
        let place = document.place(&node.span);
        names.extend(words(text).map(|word| (word.clone(), place.clone().of_item(&word))));
    }
    Ok(names)
}

/// A path without `.` and, where that is possible, without `..`, so that one file has one name.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        let is_name = matches!(plain.components().next_back(), Some(Component::Normal(_)));
        match part {
            Component::CurDir => {}
            Component::ParentDir if is_name => {
                plain.pop();
            }
            part => plain.push(part),
        }
    }
    plain
}

/// Adds to a table at a path what is inherited and not in it.
pub(super) fn join(own: &mut Table, inherited: Table, path: &str) {
    for (name, theirs) in inherited.entries {
        let path = match path {
            "" => name.clone(),
            path => format!("{path}.{name}"),
        };
        let Some(mine) = own.entries.get_mut(&name) else {
            own.entries.insert(name, theirs);
            continue;
        };
        if is_choice(&path) {
            join_options(mine, theirs, &path);
        } else if let (Some(mine), Value::Table(theirs)) =
            (table(&mut mine.node), theirs.node.value)
            && theirs.wrapped().is_none()
        {
            join(mine, theirs, &path);
        }
    }
}

/// As [`join`] for a choice: another option replaces the inherited one with all its keys.
fn join_options(mine: &mut Entry, theirs: Entry, path: &str) {
    let word = match &mine.node.inner().value {
        Value::Text(word) => Some(word.clone()),
        _ => None,
    };
    let Value::Table(options) = &theirs.node.value else {
        return;
    };
    let has = |name: &String| options.entries.contains_key(name);
    if word.is_some_and(|word| has(&word)) {
        // The inherited option by its word.
        *mine = theirs;
    } else if let Some(mine) = table(&mut mine.node)
        && mine.entries.keys().all(has)
        && let Value::Table(options) = theirs.node.value
    {
        join(mine, options, path);
    }
}

/// The table that a node is, unless it is a value with its origin.
fn table(node: &mut Node) -> Option<&mut Table> {
    match &mut node.value {
        Value::Table(table) if table.wrapped().is_none() => Some(table),
        _ => None,
    }
}

/// True if an option is chosen at a path.
fn is_choice(path: &str) -> bool {
    static CHOICES: OnceLock<BTreeSet<String>> = OnceLock::new();
    let choices = CHOICES.get_or_init(|| {
        let mut choices = BTreeSet::new();
        VEHICLE.walk("", &mut |path, key| {
            if matches!(key.kind, keys::Kind::Options(_)) {
                choices.insert(path);
            }
        });
        choices
    });
    choices.contains(path)
}
