//! Sources computed once and seen by expressions, whatever the cars come from.

use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::hash::Hash;
use std::rc::Rc;

use super::expr::{MAX_EVALUATIONS, Table, Tables};
use super::source::{Kind, Source};
use super::tables::{self, Driven};
use cvtcycle_config::Target;
use cvtcycle_config::setup::Setup;
use cvtcycle_config::{KeyInfo, Place, Problems};
use cvtcycle_model::rig::transmission::Conditions;

/// Where the cars and the rig of the sources come from.
pub trait Cars {
    /// The car of a source; the subject for none.
    ///
    /// # Errors
    /// Problems of its files or numbers.
    fn setup(&self, source: Option<&Source>) -> Result<Rc<Setup>, Problems>;

    /// Conditions of the transmission rig for a source.
    ///
    /// # Errors
    /// Problems of its values.
    fn conditions(&self, source: Option<&Source>) -> Result<(Conditions, Vec<KeyInfo>), Problems>;
}

/// The value for a key, made once.
pub fn once<K: Eq + Hash, T: Clone>(
    map: &RefCell<HashMap<K, T>>,
    key: K,
    make: impl FnOnce() -> T,
) -> T {
    if let Some(found) = map.borrow().get(&key) {
        return found.clone();
    }
    let made = make();
    map.borrow_mut().insert(key, made.clone());
    made
}

/// A table, or why there is none.
type Made = Result<Rc<Table>, String>;
/// The source of a key, and its item of a list.
type Owner = (Option<usize>, Option<usize>);
/// Numbers of keys by their paths, or why there are none.
type Numbers = HashMap<String, Result<f64, String>>;

/// Everything that was computed, shared by all expressions: sources of equal contents are one.
pub struct Store<'a> {
    cars: &'a dyn Cars,
    runs: RefCell<HashMap<String, Result<Rc<Driven>, String>>>,
    tables: RefCell<HashMap<String, Made>>,
    /// Evaluations that are left; none after one was refused.
    left: Cell<Option<u64>>,
}

impl<'a> Store<'a> {
    /// With nothing computed yet.
    pub fn new(cars: &'a dyn Cars) -> Self {
        Store {
            cars,
            runs: RefCell::default(),
            tables: RefCell::default(),
            left: Cell::new(Some(MAX_EVALUATIONS)),
        }
    }

    fn spend(&self, evaluations: u64) -> Result<(), String> {
        let left = self
            .left
            .get()
            .and_then(|left| left.checked_sub(evaluations));
        self.left.set(left);
        left.map(drop).ok_or_else(|| {
            format!(
                "more than {MAX_EVALUATIONS} evaluations; nested each, span and reductions multiply"
            )
        })
    }

    /// Evaluations so far; `None` above the limit.
    pub fn evaluations(&self) -> Option<u64> {
        self.left.get().map(|left| MAX_EVALUATIONS - left)
    }

    /// The table of a source, or of its totals.
    ///
    /// # Errors
    /// Why it cannot be computed.
    pub fn table(&self, source: &Source, totals: bool) -> Result<Rc<Table>, String> {
        let bare = Source {
            name: String::new(),
            place: Place::default(),
            ..source.clone()
        };
        once(&self.tables, format!("{totals} {bare:?}"), || {
            self.compute(&bare, totals).map(Rc::new)
        })
    }

    fn compute(&self, source: &Source, totals: bool) -> Result<Table, String> {
        let setup = self.cars.setup(Some(source)).map_err(|problems| {
            let first = problems
                .first()
                .map(|problem| format!(": {}", problem.message));
            format!("its vehicle cannot be loaded{}", first.unwrap_or_default())
        })?;
        if source.kind != Kind::Run {
            let (conditions, _) = self.rig(Some(source))?;
            return tables::table(source, &setup, &conditions);
        }
        // Phases of the same run share it.
        let whole = Source {
            phase: String::new(),
            ..source.clone()
        };
        let drive = || tables::drive(&whole, &setup).map(Rc::new);
        let driven = once(&self.runs, format!("{whole:?}"), drive);
        Ok(tables::of_run(source, &driven?, totals))
    }

    fn rig(&self, source: Option<&Source>) -> Result<(Conditions, Vec<KeyInfo>), String> {
        let conditions = self.cars.conditions(source);
        conditions.map_err(|_| "the rig's conditions cannot be read".to_owned())
    }
}

/// The store as the expressions of one file see it.
pub struct View<'a> {
    store: &'a Store<'a>,
    sources: &'a [Source],
    left_out: Cell<usize>,
    outside: Cell<usize>,
    /// Tables by source, cached: expressions may read them in every evaluation.
    tables: RefCell<HashMap<(usize, bool), Made>>,
    keys: RefCell<HashMap<Owner, Numbers>>,
}

impl<'a> View<'a> {
    /// With the sources that the expressions count from 0.
    pub fn new(store: &'a Store<'a>, sources: &'a [Source]) -> Self {
        View {
            store,
            sources,
            left_out: Cell::default(),
            outside: Cell::default(),
            tables: RefCell::default(),
            keys: RefCell::default(),
        }
    }

    /// Forgets what was noted.
    pub fn begin(&self) {
        self.left_out.set(0);
        self.outside.set(0);
    }

    fn find_key(
        &self,
        source: Option<usize>,
        path: &str,
        item: Option<usize>,
    ) -> Result<f64, String> {
        let spec = source.and_then(|k| self.sources.get(k));
        let of_keys = |owner: &str, keys: &[KeyInfo]| {
            let info = keys.iter().find(|info| info.key == path);
            let info = info.ok_or_else(|| format!("the {owner} has no `{path}`"))?;
            number_of(info, item)
                .ok_or_else(|| format!("`{path}` is no number here: {}", info.value))
        };
        if Target::from_key(path).0 == Target::Rig {
            return of_keys("rig", &self.store.rig(spec)?.1);
        }
        let setup = self.store.cars.setup(spec);
        let setup = setup.map_err(|_| "the vehicle cannot be loaded".to_owned())?;
        of_keys(&format!("vehicle `{}`", setup.name), &setup.keys)
    }

    /// Points left out because of gross slip, and points that count though they lie outside the validity of a model.
    pub fn noted(&self) -> (usize, usize) {
        (self.left_out.get(), self.outside.get())
    }
}

impl Tables for View<'_> {
    fn table(&self, source: usize, totals: bool) -> Result<Rc<Table>, String> {
        once(&self.tables, (source, totals), || {
            let spec = self.sources.get(source).ok_or("no such source")?;
            let table = self.store.table(spec, totals);
            table.map_err(|why| format!("source `{}`: {why}", spec.name))
        })
    }

    fn key(&self, source: Option<usize>, path: &str, item: Option<usize>) -> Result<f64, String> {
        let known = self
            .keys
            .borrow()
            .get(&(source, item))
            .and_then(|keys| keys.get(path).cloned());
        known.unwrap_or_else(|| {
            let found = self.find_key(source, path, item);
            let mut keys = self.keys.borrow_mut();
            let keys = keys.entry((source, item)).or_default();
            keys.insert(path.to_owned(), found.clone());
            found
        })
    }

    fn spend(&self, evaluations: u64) -> Result<(), String> {
        self.store.spend(evaluations)
    }

    fn left_out(&self, rows: usize) {
        self.left_out.set(self.left_out.get() + rows);
    }

    fn outside(&self, rows: usize) {
        self.outside.set(self.outside.get() + rows);
    }
}

/// A key's number in its own unit, an item of a list, 1 and 0 for true and false.
fn number_of(info: &KeyInfo, item: Option<usize>) -> Option<f64> {
    match (info.value.as_str(), item) {
        ("true", None) => Some(1.0),
        ("false", None) => Some(0.0),
        (value, None) => value.parse().ok(),
        (value, Some(k)) => {
            let inner = value.strip_prefix('[')?.strip_suffix(']')?;
            inner.split(',').nth(k)?.trim().parse().ok()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CandidateVehicle;
    use cvtcycle_config::setup::{Options, load};

    /// The shipped car, and how often it and the rig were made.
    #[derive(Default)]
    struct Counted {
        made: Cell<usize>,
    }

    impl Cars for Counted {
        fn setup(&self, _: Option<&Source>) -> Result<Rc<Setup>, Problems> {
            self.made.set(self.made.get() + 1);
            load("rover_216_cvt", &Options::default()).map(Rc::new)
        }

        fn conditions(
            &self,
            source: Option<&Source>,
        ) -> Result<(Conditions, Vec<KeyInfo>), Problems> {
            self.made.set(self.made.get() + 1);
            CandidateVehicle::default().conditions(source)
        }
    }

    /// However often an expression looks for a key, its car or rig is made once: a loop may do it millions of times.
    #[test]
    fn a_key_is_found_once() {
        let cars = Counted::default();
        let store = Store::new(&cars);
        let view = View::new(&store, &[]);
        let keys = [
            ("road_load.mass_kg", None),
            ("rig.transient.speed_rpm", None),
            ("no.such_key", None),
            ("road_load.mass_kg", Some(1)),
        ];
        for (number, (path, item)) in keys.into_iter().enumerate() {
            let first = view.key(None, path, item);
            assert_eq!(first.is_ok(), number < 2, "{first:?}");
            for _ in 0..10 {
                assert_eq!(view.key(None, path, item), first);
            }
            assert_eq!(cars.made.get(), number + 1, "{path}");
        }
        assert!(view.table(0, false).is_err() && view.table(0, true).is_err());
        assert_eq!(cars.made.get(), keys.len());
    }
}
