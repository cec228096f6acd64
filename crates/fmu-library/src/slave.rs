//! Instances behind C pointers, statuses, and the master's logger.
#![expect(
    unsafe_code,
    reason = "pointers of C are read and written, and the master's logger is called"
)]

use std::any::Any;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::{ptr, slice};

use cvtcycle_fmu::ProblemKind::{Conflict, Missing, TooLarge, WrongType};
use cvtcycle_fmu::unit::Saved;
use cvtcycle_fmu::{Refusal, Unit};

/// Statuses, equal in `fmi2Status` and `fmi3Status`.
pub const OK: c_int = 0;
pub const WARNING: c_int = 1;
pub const ERROR: c_int = 3;
pub const FATAL: c_int = 4;

/// `fmi2CallbackLogger`.
pub type Log2 =
    unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, ...);

/// `fmi3LogMessageCallback`.
pub type Log3 = unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char);

/// Logger of the master, with its context.
#[derive(Clone, Copy)]
pub enum Logger {
    Fmi2(Option<Log2>, *mut c_void),
    Fmi3(Option<Log3>, *mut c_void),
}

impl Logger {
    /// Sends a message with a status to the master.
    pub fn log(self, name: &CStr, status: c_int, message: &str) {
        let text = |message: &str| CString::new(message.replace('\0', " ")).unwrap_or_default();
        let category = match status {
            OK | WARNING => c"logStatusWarning",
            FATAL => c"logStatusFatal",
            _ => c"logStatusError",
        };
        match self {
            Logger::Fmi2(Some(log), environment) => {
                // The logger expects a printf format.
                let message = text(&message.replace('%', "%%"));
                // SAFETY: the logger and its environment are those of fmi2Instantiate, valid as long as the instance; texts end with 0.
                unsafe {
                    log(
                        environment,
                        name.as_ptr(),
                        status,
                        category.as_ptr(),
                        message.as_ptr(),
                    );
                }
            }
            Logger::Fmi3(Some(log), environment) => {
                let message = text(message);
                // SAFETY: as above, of fmi3InstantiateCoSimulation.
                unsafe { log(environment, status, category.as_ptr(), message.as_ptr()) };
            }
            Logger::Fmi2(None, _) | Logger::Fmi3(None, _) => {}
        }
    }
}

/// Instance of a unit.
pub struct Slave {
    pub unit: Unit,
    /// Start time of the simulation, s. FMI 2 and 3 give it before initialization.
    pub start_s: f64,
    name: CString,
    logger: Logger,
    /// True after a panic, which may have left the unit inconsistent.
    poisoned: bool,
}

/// Arguments of an instantiation.
pub struct Instantiation {
    pub name: *const c_char,
    pub token: *const c_char,
    pub resources: *const c_char,
    pub logger: Logger,
}

/// Message of a panic.
fn panic_message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(ToString::to_string);
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
    format!("defect in cvtcycle: {}", text.unwrap_or_default())
}

/// Converts a C string; None for a null pointer.
pub fn text(text: *const c_char) -> Option<String> {
    if text.is_null() {
        return None;
    }
    // SAFETY: not null, and the standard has texts end with 0.
    let text = unsafe { CStr::from_ptr(text) };
    Some(text.to_string_lossy().into_owned())
}

/// Creates an instance; `folder` converts the path of the resources. Null, with a log message, on failure.
pub fn instantiate(
    arguments: &Instantiation,
    folder: fn(&str) -> Result<String, Refusal>,
) -> *mut c_void {
    let name = CString::new(text(arguments.name).unwrap_or_default()).unwrap_or_default();
    let made = catch_unwind(|| {
        let absent = |what: &str| Refusal::new(Missing, format!("the {what} is missing"));
        let token = text(arguments.token).ok_or_else(|| absent("token (FMI 2: GUID)"))?;
        let resources = text(arguments.resources).ok_or_else(|| absent("path of the resources"))?;
        Unit::open(Path::new(&folder(&resources)?), &token)
    });
    let refused = |status: c_int, message: &str| {
        arguments.logger.log(&name, status, message);
        ptr::null_mut()
    };
    match made {
        Ok(Ok(unit)) => {
            let slave = Slave {
                unit,
                start_s: 0.0,
                name,
                logger: arguments.logger,
                poisoned: false,
            };
            Box::into_raw(Box::new(slave)).cast()
        }
        Ok(Err(refusal)) => refused(ERROR, &refusal.message),
        Err(panic) => refused(FATAL, &panic_message(&*panic)),
    }
}

/// Calls a function of an instance and returns its status.
pub fn call(instance: *mut c_void, f: impl FnOnce(&mut Slave) -> Result<(), Refusal>) -> c_int {
    // SAFETY: null, or a pointer of `instantiate` that is not freed; the standard has one call at a time for each instance.
    let Some(slave) = (unsafe { instance.cast::<Slave>().as_mut() }) else {
        return ERROR;
    };
    if slave.poisoned {
        return FATAL;
    }
    let (status, message) = match catch_unwind(AssertUnwindSafe(|| f(slave))) {
        Ok(Ok(())) => return OK,
        Ok(Err(refusal)) if refusal.warns => (WARNING, refusal.message),
        Ok(Err(refusal)) => (ERROR, refusal.message),
        Err(panic) => {
            slave.poisoned = true;
            (FATAL, panic_message(&*panic))
        }
    };
    slave.logger.log(&slave.name, status, &message);
    status
}

/// Frees an instance.
pub fn free(instance: *mut c_void) {
    if !instance.is_null() {
        // SAFETY: a pointer of `instantiate`, which the master gives back once.
        let slave = unsafe { Box::from_raw(instance.cast::<Slave>()) };
        // A panic in a destructor must not cross the C boundary either.
        drop(catch_unwind(AssertUnwindSafe(|| drop(slave))));
    }
}

/// Views an input array of the master.
pub fn input_array<'a, T>(first: *const T, count: usize) -> Result<&'a [T], Refusal> {
    if count == 0 {
        return Ok(&[]);
    }
    match first.is_null() {
        true => Err(Refusal::new(Missing, "an array is missing")),
        // SAFETY: not null; the master says that there are so many, and lends them for the call.
        false => Ok(unsafe { slice::from_raw_parts(first, count) }),
    }
}

/// Views an output array of the master.
pub fn output_array<'a, T>(first: *mut T, count: usize) -> Result<&'a mut [T], Refusal> {
    if count == 0 {
        return Ok(&mut []);
    }
    match first.is_null() {
        true => Err(Refusal::new(Missing, "an array is missing")),
        // SAFETY: as in `input_array`, and the master lends them to this call alone.
        false => Ok(unsafe { slice::from_raw_parts_mut(first, count) }),
    }
}

/// Writes one value through an optional output pointer.
pub fn write_output<T>(place: *mut T, value: T) {
    if !place.is_null() {
        // SAFETY: not null, and the master lends it for the call.
        unsafe { place.write(value) };
    }
}

impl Slave {
    /// Reads variables of a type, integers if `whole`.
    pub fn get<T>(
        &mut self,
        (references, count): (*const u32, usize),
        (values, value_count): (*mut T, usize),
        whole: bool,
        of: fn(f64) -> T,
    ) -> Result<(), Refusal> {
        self.check_count(count, value_count)?;
        let places = output_array(values, count)?;
        for (reference, place) in input_array(references, count)?.iter().zip(places) {
            self.check_type(*reference, whole)?;
            *place = of(self.unit.get(*reference)?);
        }
        Ok(())
    }

    /// Sets variables of a type. Stops at the first refused one.
    pub fn set<T: Copy>(
        &mut self,
        (references, count): (*const u32, usize),
        (values, value_count): (*const T, usize),
        whole: bool,
        of: fn(T) -> f64,
    ) -> Result<(), Refusal> {
        self.check_count(count, value_count)?;
        let values = input_array(values, count)?;
        for (reference, value) in input_array(references, count)?.iter().zip(values) {
            self.check_type(*reference, whole)?;
            self.unit.set(*reference, of(*value))?;
        }
        Ok(())
    }

    fn check_count(&self, references: usize, values: usize) -> Result<(), Refusal> {
        match references == values {
            true => Ok(()),
            false => {
                let message = format!("{references} value references and {values} values");
                Err(Refusal::new(Conflict, message))
            }
        }
    }

    fn check_type(&self, reference: u32, whole: bool) -> Result<(), Refusal> {
        if self.unit.is_whole(reference)? == whole {
            return Ok(());
        }
        let kind = if whole { "whole" } else { "real" };
        let message = format!("the variable with value reference {reference} is no {kind} number");
        Err(Refusal::new(WrongType, message))
    }

    /// Saves the state at a place, reusing a state already there.
    pub fn save(&mut self, place: *mut *mut c_void) -> Result<(), Refusal> {
        let [state] = output_array(place, 1)? else {
            return Ok(());
        };
        // SAFETY: null, or a state of this function that is not freed.
        match unsafe { state.cast::<Saved>().as_mut() } {
            Some(saved) => *saved = self.unit.save(),
            None => *state = Box::into_raw(Box::new(self.unit.save())).cast(),
        }
        Ok(())
    }

    /// Checks and returns a saved state.
    pub fn saved<'a>(&self, state: *mut c_void) -> Result<&'a Saved, Refusal> {
        // SAFETY: null, or a state of `save` that is not freed.
        let saved = unsafe { state.cast::<Saved>().as_ref() };
        saved.ok_or_else(|| Refusal::new(Missing, "the saved state is missing"))
    }

    /// Frees a saved state.
    pub fn free_saved(&mut self, place: *mut *mut c_void) -> Result<(), Refusal> {
        if place.is_null() {
            return Ok(());
        }
        let [state] = output_array(place, 1)? else {
            return Ok(());
        };
        if !state.is_null() {
            // SAFETY: a state of `save`; the pointer is null from now on, so that it is freed once.
            drop(unsafe { Box::from_raw(state.cast::<Saved>()) });
            *state = ptr::null_mut();
        }
        Ok(())
    }

    /// Serialises a saved state.
    pub fn to_bytes(&self, state: *mut c_void) -> Result<Vec<u8>, Refusal> {
        Ok(self.unit.to_bytes(self.saved(state)?))
    }

    /// Serialises a saved state into an array of the master.
    pub fn write_bytes(
        &self,
        state: *mut c_void,
        (first, size): (*mut u8, usize),
    ) -> Result<(), Refusal> {
        let bytes = self.to_bytes(state)?;
        let Some(place) = output_array(first, size)?.get_mut(..bytes.len()) else {
            let needed = bytes.len();
            let message = format!("the state has {needed} bytes, the array {size}");
            return Err(Refusal::new(TooLarge, message));
        };
        place.copy_from_slice(&bytes);
        Ok(())
    }

    /// Deserialises a state to a place, without changing the unit.
    pub fn read_bytes(
        &mut self,
        (first, size): (*const u8, usize),
        place: *mut *mut c_void,
    ) -> Result<(), Refusal> {
        let before = self.unit.save();
        self.unit.restore_bytes(input_array(first, size)?)?;
        let made = self.save(place);
        self.unit.restore(&before)?;
        made
    }
}
