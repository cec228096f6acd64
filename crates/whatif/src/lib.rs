//! The simulator in a page. `tools/live` builds it for wasm32-unknown-unknown and compresses it into `crates/report/assets`, where `report`
//! finds it; `reports/live.js` calls it.
//!
//! Everything goes through two buffers of JSON: JavaScript gets room from [`live_reserve`], writes the input there, calls a function, which
//! returns the length of its output, and reads that many bytes from [`live_output`]. Both buffers stay where they are until the next call.
//! A name that JavaScript finds is the only thing here that Rust calls unsafe: another symbol of that name would take its place.

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

/// A state, and the differences that were drawn for it.
#[derive(Deserialize)]
struct Asked {
    state: State,
    #[serde(default)]
    drawn: Option<Vec<DrawnDifference>>,
}

/// What a part of the draws gives.
#[derive(Serialize)]
struct Drawn {
    /// After the last part.
    drawn: Option<Vec<DrawnDifference>>,
    /// Why there are none.
    problem: Option<String>,
}

/// Room for the input of the next call, at least `length` bytes.
#[unsafe(no_mangle)]
pub extern "C" fn live_reserve(length: usize) -> *mut u8 {
    LIVE.with_borrow_mut(|live| {
        live.input.clear();
        live.input.resize(length, 0);
        live.input.as_mut_ptr()
    })
}

/// The output of the last call.
#[unsafe(no_mangle)]
pub extern "C" fn live_output() -> *const u8 {
    LIVE.with_borrow(|live| live.output.as_ptr())
}

/// Reads the scene of the page. The output is null, or a sentence on what is wrong.
#[unsafe(no_mangle)]
pub extern "C" fn live_open() -> usize {
    call(|live| {
        let scene: Scene = parsed(&live.input)?;
        live.page = Some(LivePage::open(scene)?);
        Ok(None::<String>)
    })
}

/// The answer to a state, with its intervals if they are given.
#[unsafe(no_mangle)]
pub extern "C" fn live_answer() -> usize {
    call(|live| {
        let asked: Asked = parsed(&live.input)?;
        let page = live.page.as_mut().ok_or_else(not_open)?;
        Ok(page.answer(&asked.state, asked.drawn))
    })
}

/// Drives the next part of the draws of a state.
#[unsafe(no_mangle)]
pub extern "C" fn live_draw() -> usize {
    call(|live| {
        let asked: Asked = parsed(&live.input)?;
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

/// Puts what a call makes into the output, or the sentence on what is wrong; the length.
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
