//! The functions of the standard for co-simulation, over [`Model`].
//!
//! Source: Functional Mock-up Interface Specification 3.0, sections 2.2 (common functions) and 4 (co-simulation). A function
//! that the unit does not support returns `fmi3Error`. A panic becomes `fmi3Fatal`.
#![allow(
    unsafe_code,
    reason = "a C interface reads and writes through the caller's pointers"
)]
#![allow(non_snake_case, reason = "names of the standard")]
#![allow(
    clippy::missing_safety_doc,
    reason = "pointers are those of the standard: to as many values as the argument next to them"
)]

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::ptr::null_mut;

use grouser_terra::SolveStatus;

use crate::model::{Inputs, Model, Outputs};
use crate::resources;
use crate::variables::{INPUTS, STATUS, TIME, VARIABLES, cautions, place};

/// `fmi3Status`.
type Status = c_int;
const OK: Status = 0;
const WARNING: Status = 1;
const DISCARD: Status = 2;
const ERROR: Status = 3;
const FATAL: Status = 4;

/// `fmi3LogMessageCallback`.
type LogMessage = unsafe extern "C" fn(*mut c_void, Status, *const c_char, *const c_char);

/// Where a unit is in its life.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mode {
    Instantiated,
    Initialization,
    Step,
    Terminated,
}

/// What `fmi3GetFMUState` copies.
#[derive(Clone, Copy, Debug)]
struct State {
    inputs: Inputs,
    time: f64,
    mode: Mode,
}

/// What C sees as `fmi3Instance`.
struct Instance {
    model: Model,
    state: State,
    /// The outputs at the inputs, once they were needed.
    outputs: Option<Outputs>,
    is_logging: bool,
    environment: *mut c_void,
    log: Option<LogMessage>,
}

/// A call that failed, with its status.
struct Refused(Status, String);

type Found<T> = Result<T, Refused>;

fn refused<T>(message: impl Into<String>) -> Found<T> {
    Err(Refused(ERROR, message.into()))
}

fn log(log: Option<LogMessage>, environment: *mut c_void, status: Status, message: &str) {
    let is_warning = status == WARNING;
    let category = if is_warning {
        c"logStatusWarning"
    } else {
        c"logStatusError"
    };
    if let (Some(log), Ok(message)) = (log, CString::new(message)) {
        // SAFETY: the callback and its environment are those that the importer instantiated the unit with
        unsafe { log(environment, status, category.as_ptr(), message.as_ptr()) }
    }
}

impl Instance {
    fn outputs(&mut self) -> Outputs {
        let (model, inputs) = (&self.model, &self.state.inputs);
        *self.outputs.get_or_insert_with(|| model.outputs(inputs))
    }

    fn restore(&mut self, state: State) {
        (self.state, self.outputs) = (state, None);
    }

    fn lead(&mut self, from: Mode, to: Mode) -> Found<()> {
        let now = self.state.mode;
        if now != from {
            return refused(format!("from the mode {now:?} no call leads to {to:?}"));
        }
        self.state.mode = to;
        Ok(())
    }

    fn set(&mut self, reference: u32, value: f64) -> Found<()> {
        let variable = place(reference).and_then(|place| Some((place, VARIABLES[place].limits?)));
        let Some((input, (low, high))) = variable else {
            return refused(format!("the variable {reference} is no input"));
        };
        if !(value >= low && value <= high) {
            let name = VARIABLES[input].name;
            return refused(format!(
                "{name} is {value}, but must lie in [{low}, {high}]"
            ));
        }
        self.state.inputs[input] = value;
        self.outputs = None;
        Ok(())
    }

    fn number(&mut self, reference: u32) -> Found<f64> {
        match place(reference) {
            Some(place) if place < INPUTS => Ok(self.state.inputs[place]),
            Some(place) => Ok(self.outputs().numbers[place - INPUTS]),
            None if reference == TIME => Ok(self.state.time),
            None => refused(format!("the variable {reference} is no Float64")),
        }
    }

    fn code(&mut self, reference: u32) -> Found<i64> {
        match reference {
            STATUS => Ok(i64::from(self.outputs().status.code())),
            _ => refused(format!("the variable {reference} is no Int64")),
        }
    }

    fn has_caution(&mut self, reference: u32) -> Found<bool> {
        match cautions().find(|(own, _)| *own == reference) {
            Some((_, caution)) => Ok(self.outputs().cautions.contains(caution)),
            None => refused(format!("the variable {reference} is no Boolean")),
        }
    }

    fn step(&mut self, from: f64, step: f64) -> Found<()> {
        self.lead(Mode::Step, Mode::Step)?;
        if !(step > 0.0 && (from + step).is_finite()) {
            return refused(format!("a step from {from} s by {step} s"));
        }
        self.state.time = from + step;
        match self.outputs().status {
            SolveStatus::Solved => Ok(()),
            other => {
                let [load, slip, angle] = self.state.inputs;
                let at = format!("a load of {load} N, slip {slip} and {angle} deg");
                Err(Refused(
                    WARNING,
                    format!("{}: no numbers at {at}", other.key()),
                ))
            }
        }
    }

    /// The derivatives of the unknowns along `seed` of the knowns.
    fn derive(
        &self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        found: &mut [f64],
    ) -> Found<()> {
        let Some(rows) = self.model.derivatives(&self.state.inputs) else {
            let message = "no derivatives: no solution, no load, or a locked wheel";
            return Err(Refused(DISCARD, message.to_owned()));
        };
        if unknowns.len() != found.len() || knowns.len() != seed.len() {
            return refused("as many values as variables are needed");
        }
        for (unknown, found) in unknowns.iter().zip(found) {
            *found = 0.0;
            for (known, seed) in knowns.iter().zip(seed) {
                let output = place(*unknown).and_then(|place| place.checked_sub(INPUTS));
                let input = place(*known).filter(|place| *place < INPUTS);
                let (Some(output), Some(input)) = (output, input) else {
                    return refused(format!("no derivative of {unknown} in {known}"));
                };
                *found += rows[output][input] * seed;
            }
        }
        Ok(())
    }
}

/// Runs a call on an instance; logs why it failed.
unsafe fn call(instance: *mut c_void, body: impl FnOnce(&mut Instance) -> Found<()>) -> Status {
    // SAFETY: an instance is what fmi3InstantiateCoSimulation returned, and is used by one thread at a time
    let Some(instance) = (unsafe { instance.cast::<Instance>().as_mut() }) else {
        return ERROR;
    };
    match catch_unwind(AssertUnwindSafe(|| body(instance))) {
        Ok(Ok(())) => OK,
        Ok(Err(Refused(status, message))) => {
            if instance.is_logging {
                log(instance.log, instance.environment, status, &message);
            }
            status
        }
        Err(_) => FATAL,
    }
}

/// Values of the caller.
unsafe fn values<'a, T>(first: *const T, count: usize) -> Found<&'a [T]> {
    match (count, first.is_null()) {
        (0, _) => Ok(&[]),
        (_, true) => refused("a null pointer"),
        // SAFETY: by the standard it points to `count` values
        (_, false) => Ok(unsafe { std::slice::from_raw_parts(first, count) }),
    }
}

/// Values that the caller receives.
unsafe fn values_mut<'a, T>(first: *mut T, count: usize) -> Found<&'a mut [T]> {
    match (count, first.is_null()) {
        (0, _) => Ok(&mut []),
        (_, true) => refused("a null pointer"),
        // SAFETY: by the standard it points to `count` values, which nobody else uses during the call
        (_, false) => Ok(unsafe { std::slice::from_raw_parts_mut(first, count) }),
    }
}

unsafe fn text<'a>(text: *const c_char) -> Option<&'a str> {
    // SAFETY: by the standard a text ends with 0
    (!text.is_null())
        .then(|| unsafe { CStr::from_ptr(text) })?
        .to_str()
        .ok()
}

/// The version of the standard.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// Makes a unit out of its resources; null where they do not fit the token, or cannot be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _name: *const c_char,
    token: *const c_char,
    folder: *const c_char,
    _is_visible: bool,
    is_logging: bool,
    _has_events: bool,
    _may_return_early: bool,
    _intermediate: *const u32,
    _intermediate_count: usize,
    environment: *mut c_void,
    log_message: Option<LogMessage>,
    _intermediate_update: *mut c_void,
) -> *mut c_void {
    let made = catch_unwind(|| {
        // SAFETY: the caller's
        let (token, folder) = unsafe { (text(token), text(folder)) };
        let folder = folder.ok_or("the unit needs the path of its resources")?;
        let (model, own) = resources::read(Path::new(folder)).map_err(|error| error.to_string())?;
        let refused = format!("the token is not {own}: description and resources differ");
        (token == Some(&own)).then_some(model).ok_or(refused)
    });
    match made {
        Ok(Ok(model)) => Box::into_raw(Box::new(Instance {
            state: start(&model),
            model,
            outputs: None,
            is_logging,
            environment,
            log: log_message,
        }))
        .cast(),
        Ok(Err(message)) => {
            log(log_message, environment, ERROR, &message);
            null_mut()
        }
        Err(_) => null_mut(),
    }
}

fn start(model: &Model) -> State {
    State {
        inputs: model.start,
        time: 0.0,
        mode: Mode::Instantiated,
    }
}

/// Ends a unit.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: *mut c_void) {
    if !instance.is_null() {
        // SAFETY: it is what fmi3InstantiateCoSimulation returned, and is not used again
        drop(unsafe { Box::from_raw(instance.cast::<Instance>()) });
    }
}

/// Declares functions of the standard that work on an instance.
macro_rules! functions {
    ($($(#[$doc:meta])+ $name:ident($unit:ident $(, $argument:ident: $kind:ty)* $(,)?) $body:block)+) => {$(
        $(#[$doc])+
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(instance: *mut c_void $(, $argument: $kind)*) -> Status {
            // SAFETY: pointers are those of the standard
            unsafe { call(instance, |$unit| $body) }
        }
    )+};
}

/// Declares functions that read variables of one type.
macro_rules! getters {
    ($($(#[$doc:meta])+ $name:ident($kind:ty) = $get:path;)+) => {functions! {$(
        $(#[$doc])+
        $name(unit, references: *const u32, count: usize, found: *mut $kind, found_count: usize) {
            let (references, found) = (values(references, count)?, values_mut(found, found_count)?);
            let mut pairs = references.iter().zip(found);
            pairs.try_for_each(|(reference, found)| $get(unit, *reference).map(|value| *found = value))
        }
    )+}};
}

/// Declares functions for variables of types that the unit does not have: there are none to read or set.
macro_rules! no_variables {
    ($($name:ident)+) => {functions! {$(
        /// No variable has this type.
        $name(_unit, _references: *const u32, count: usize) {
            if count == 0 { Ok(()) } else { refused(concat!(stringify!($name), ": no variable has this type")) }
        }
    )+}};
}

/// Declares functions that the unit does not support. They look at their first argument only, so further ones, which the
/// calling conventions of C leave to the caller, are not declared.
macro_rules! unsupported {
    ($($name:ident)+) => {functions! {$(
        /// Not supported.
        $name(_unit) { refused(concat!(stringify!($name), " is not supported")) }
    )+}};
}

functions! {
    /// Switches messages on or off; all categories alike.
    fmi3SetDebugLogging(unit, is_logging: bool, _count: usize, _categories: *const *const c_char) {
        unit.is_logging = is_logging;
        Ok(())
    }

    /// Begins the initialization.
    fmi3EnterInitializationMode(unit, _has_tolerance: bool, _tolerance: f64, start: f64, _has_stop: bool, _stop: f64) {
        unit.state.time = start;
        unit.lead(Mode::Instantiated, Mode::Initialization)
    }

    /// Ends the initialization.
    fmi3ExitInitializationMode(unit) { unit.lead(Mode::Initialization, Mode::Step) }

    /// Goes back to steps; there are no events.
    fmi3EnterStepMode(unit) { unit.lead(Mode::Step, Mode::Step) }

    /// Ends the simulation.
    fmi3Terminate(unit) { unit.lead(Mode::Step, Mode::Terminated) }

    /// Back to the start, as instantiated.
    fmi3Reset(unit) {
        unit.restore(start(&unit.model));
        Ok(())
    }

    /// Sets inputs.
    fmi3SetFloat64(unit, references: *const u32, count: usize, given: *const f64, given_count: usize) {
        let (references, given) = (values(references, count)?, values(given, given_count)?);
        references.iter().zip(given).try_for_each(|(reference, value)| unit.set(*reference, *value))
    }

    /// Moves on by a step, after which the outputs are those of the inputs.
    fmi3DoStep(
        unit, from: f64, step: f64, _no_state_before: bool, needs_events: *mut bool, terminates: *mut bool,
        is_early: *mut bool, until: *mut f64,
    ) {
        for flag in [needs_events, terminates, is_early] {
            values_mut(flag, 1)?[0] = false;
        }
        let done = unit.step(from, step);
        values_mut(until, 1)?[0] = unit.state.time;
        done
    }

    /// Copies the state; a state that is given is overwritten.
    fmi3GetFMUState(unit, state: *mut *mut c_void) {
        let to = &mut values_mut(state, 1)?[0];
        match to.cast::<State>().as_mut() {
            Some(own) => *own = unit.state,
            None => *to = Box::into_raw(Box::new(unit.state)).cast(),
        }
        Ok(())
    }

    /// Goes back to a state.
    fmi3SetFMUState(unit, state: *mut c_void) {
        unit.restore(values(state.cast::<State>(), 1)?[0]);
        Ok(())
    }

    /// Frees a state.
    fmi3FreeFMUState(_unit, state: *mut *mut c_void) {
        let state = &mut values_mut(state, 1)?[0];
        if !state.is_null() {
            drop(Box::from_raw(state.cast::<State>()));
        }
        *state = null_mut();
        Ok(())
    }

    /// The derivatives of unknowns along a direction of the known variables.
    fmi3GetDirectionalDerivative(
        unit, unknowns: *const u32, unknown_count: usize, knowns: *const u32, known_count: usize, seed: *const f64,
        seed_count: usize, found: *mut f64, found_count: usize,
    ) {
        let (unknowns, knowns) = (values(unknowns, unknown_count)?, values(knowns, known_count)?);
        unit.derive(unknowns, knowns, values(seed, seed_count)?, values_mut(found, found_count)?)
    }
}

getters! {
    /// The time, inputs and continuous outputs.
    fmi3GetFloat64(f64) = Instance::number;
    /// The status.
    fmi3GetInt64(i64) = Instance::code;
    /// Cautions.
    fmi3GetBoolean(bool) = Instance::has_caution;
}

no_variables! {
    fmi3GetFloat32 fmi3GetInt8 fmi3GetUInt8 fmi3GetInt16 fmi3GetUInt16 fmi3GetInt32 fmi3GetUInt32 fmi3GetUInt64
    fmi3GetString fmi3GetBinary fmi3GetClock
    fmi3SetFloat32 fmi3SetInt8 fmi3SetUInt8 fmi3SetInt16 fmi3SetUInt16 fmi3SetInt32 fmi3SetUInt32 fmi3SetInt64
    fmi3SetUInt64 fmi3SetBoolean fmi3SetString fmi3SetBinary fmi3SetClock
}

unsupported! {
    fmi3EnterEventMode fmi3GetNumberOfVariableDependencies fmi3GetVariableDependencies fmi3EnterConfigurationMode
    fmi3ExitConfigurationMode fmi3GetIntervalDecimal fmi3GetIntervalFraction fmi3GetShiftDecimal fmi3GetShiftFraction
    fmi3SetIntervalDecimal fmi3SetIntervalFraction fmi3SetShiftDecimal fmi3SetShiftFraction fmi3EvaluateDiscreteStates
    fmi3UpdateDiscreteStates fmi3EnterContinuousTimeMode fmi3CompletedIntegratorStep fmi3SetTime fmi3SetContinuousStates
    fmi3GetContinuousStateDerivatives fmi3GetEventIndicators fmi3GetContinuousStates fmi3GetNominalsOfContinuousStates
    fmi3GetNumberOfEventIndicators fmi3GetNumberOfContinuousStates fmi3GetOutputDerivatives fmi3ActivateModelPartition
    fmi3SerializedFMUStateSize fmi3SerializeFMUState fmi3DeserializeFMUState fmi3GetAdjointDerivative
}

/// Not supported: the unit is for co-simulation.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3InstantiateModelExchange() -> *mut c_void {
    null_mut()
}

/// Not supported: the unit is for co-simulation.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3InstantiateScheduledExecution() -> *mut c_void {
    null_mut()
}
