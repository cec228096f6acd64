//! The simulator in a page. `tools/live` builds it for wasm32-unknown-unknown and compresses it into `crates/report/assets`, where `report`
//! finds it; `reports/live.js` calls it.
//!
//! Data passes through two buffers of JSON: JavaScript reserves room with [`live_reserve`], writes the input there, calls a function, which
//! returns the length of its output, and reads that many bytes from [`live_output`]. Both buffers stay valid until the next call. The exported
//! names are the only unsafe part: another symbol of the same name would replace them.

use std::cell::RefCell;

use cvtcycle_config::{Problem, Problems};
use cvtcycle_output::summary::DrawnDifference;
use cvtcycle_report::whatif::{LivePage, Scene, State};
use serde::{Deserialize, Serialize};

/// The page and its buffers.
#[derive(Default)]
struct Live {
    input: Vec<u8>,
    output: Vec<u8>,
    page: Option<LivePage>,
}

thread_local! {
    static LIVE: RefCell<Live> = RefCell::default();
}

/// Requested state, and the differences drawn for it.
#[derive(Deserialize)]
struct DrawnState {
    state: State,
    #[serde(default)]
    drawn: Option<Vec<DrawnDifference>>,
}

/// Result of a part of the draws.
#[derive(Serialize)]
struct Drawn {
    /// Present after the last part.
    drawn: Option<Vec<DrawnDifference>>,
    /// Reason for missing draws.
    problem: Option<String>,
}

/// Reserves at least `length` bytes for the input of the next call.
#[unsafe(no_mangle)]
pub extern "C" fn live_reserve(length: usize) -> *mut u8 {
    LIVE.with_borrow_mut(|live| {
        live.input.clear();
        live.input.resize(length, 0);
        live.input.as_mut_ptr()
    })
}

/// Pointer to the output of the last call.
#[unsafe(no_mangle)]
pub extern "C" fn live_output() -> *const u8 {
    LIVE.with_borrow(|live| live.output.as_ptr())
}

/// Reads the scene of the page. The output is null, or a sentence that states the problem.
#[unsafe(no_mangle)]
pub extern "C" fn live_open() -> usize {
    call(|live| {
        let scene: Scene = parsed(&live.input)?;
        live.page = Some(LivePage::open(scene)?);
        Ok(None::<String>)
    })
}

/// Answers a state, with its intervals if they are given.
#[unsafe(no_mangle)]
pub extern "C" fn live_answer() -> usize {
    call(|live| {
        let asked: DrawnState = parsed(&live.input)?;
        let page = live.page.as_mut().ok_or_else(not_open)?;
        Ok(page.answer(&asked.state, asked.drawn))
    })
}

/// Drives the next part of the draws of a state.
#[unsafe(no_mangle)]
pub extern "C" fn live_draw() -> usize {
    call(|live| {
        let asked: DrawnState = parsed(&live.input)?;
        let page = live.page.as_mut().ok_or_else(not_open)?;
        let found = page.draw(&asked.state);
        let problem = found.as_ref().err().map(sentence);
        Ok(Drawn {
            drawn: found.ok().flatten(),
            problem,
        })
    })
}

fn parsed<T: for<'j> Deserialize<'j>>(input: &[u8]) -> Result<T, Problem> {
    serde_json::from_slice(input).map_err(|error| Problem::invalid(error.to_string()))
}

fn not_open() -> Problem {
    Problem::invalid("the page was not opened")
}

fn sentence(problems: &Problems) -> String {
    let texts = problems.iter().map(|problem| problem.message.as_str());
    texts.collect::<Vec<_>>().join("; ")
}

/// Writes a call's result, or a sentence that states the problem, into the output; returns its length.
fn call<T: Serialize>(make: impl FnOnce(&mut Live) -> Result<T, Problems>) -> usize {
    LIVE.with_borrow_mut(|live| {
        let made = make(live);
        let json = match made {
            Ok(made) => serde_json::to_vec(&made),
            Err(problems) => serde_json::to_vec(&sentence(&problems)),
        };
        live.output = json.unwrap_or_default();
        live.output.len()
    })
}
