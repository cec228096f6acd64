//! Page with levers, in addition to its answer: controls, scene and the simulator.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use cvtcycle_config::Problems;
use cvtcycle_config::cycle;
use cvtcycle_config::setup::{Kind as FileKind, Options, TWIN, is_path, is_twin, load};

use super::answer::LivePage;
use super::scene::Scene;
use crate::live_section::LiveSection;

/// Simulator, compressed; `tools/live` builds it.
#[cfg(not(target_family = "wasm"))]
const PROGRAM: &[u8] = include_bytes!("../../assets/live.wasm.gz");
/// The simulator does not embed itself.
#[cfg(target_family = "wasm")]
const PROGRAM: &[u8] = &[];

impl LiveSection {
    /// Builds the section of a scene, with its first answer and the user's files read for it.
    ///
    /// # Errors
    /// Problems of the cars and of the cycle.
    pub fn new(scene: Scene) -> Result<Self, Problems> {
        let made = || {
            let mut scene = scene.clone();
            scene.contradicted = LivePage::new(scene.clone())?.contradicted()?;
            Ok::<_, Problems>((LiveSection::answered(&scene)?, scene.contradicted))
        };
        let (made, files) = cvtcycle_config::carried::reading(made);
        let (mut section, contradicted) = made?;
        let scene = Scene {
            drawn: section.drawn.take(),
            contradicted,
            ..scene.with_files(files)
        };
        let json = serde_json::to_string(&scene).unwrap_or_default();
        // No tag may begin within a script.
        section.scene = json.replace('<', "\\u003c");
        Ok(section)
    }

    fn answered(scene: &Scene) -> Result<Self, Problems> {
        let state = scene.state.clone();
        let mut page = LivePage::new(scene.clone())?;
        let mut cars = vec![(scene.vehicle.clone(), "the car as it is".to_owned())];
        for word in &scene.baselines {
            cars.push(match is_twin(word) {
                true => (TWIN.to_owned(), "its twin with a manual box".to_owned()),
                false => (word.clone(), load(word, &Options::default())?.short),
            });
        }
        let own = |names: &[&str], word: &str| -> Vec<String> {
            let names = names.iter().map(|name| (*name).to_owned());
            let own = Some(word.to_owned()).filter(|word| is_path(word) || cycle::is_csv(word));
            own.into_iter().chain(names).collect()
        };
        let cycles = own(cycle::names(), &state.cycle);
        let cycles = match cycles.contains(&state.cycle) {
            true => cycles,
            // A constant speed, or an alias of a cycle.
            false => [state.cycle.clone()].into_iter().chain(cycles).collect(),
        };
        let oils = own(
            &FileKind::Lubricant.names(),
            state.lubricant.as_deref().unwrap_or_default(),
        );
        let (answer, drawn) = page.drawn_answer(&state)?;
        Ok(LiveSection {
            controls: page.controls().to_vec(),
            state,
            cars,
            cycles,
            oils,
            answer,
            drawn,
            scene: String::new(),
        })
    }

    /// Scene, for the page's script.
    pub fn scene(&self) -> &str {
        &self.scene
    }

    /// Simulator, for the page's script.
    pub fn program(&self) -> String {
        STANDARD.encode(PROGRAM)
    }
}
