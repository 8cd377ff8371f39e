//! A Rust model and a Rust driver, called through their tables as a host calls them.
#![allow(clippy::unwrap_used, missing_docs)]

use std::ffi::{CStr, c_char, c_void};
use std::ptr::{null, null_mut};

use pubs_plugin::table::{
    ChannelEntry, RawReading, STATUS_ABSENT, STATUS_ERROR, STATUS_OK, STATUS_PANIC, TextSink,
};
use pubs_plugin::{
    ActionSetup, BeliefSetup, Channel, ChannelKind, CheckState, ControlSetup, Driver, DriverCheck,
    DriverSetup, DriverStatus, JointSetup, JointType, Mode, ModelSetup, ObservationModel,
    PluginError, Reading, Support, Transitions, Twist, driver_table, observation_model_table,
};
use serde_json::json;

/// mean = slope · state, sigma = 2; panics at negative states.
struct Line {
    slope: f32,
    channels: Vec<Channel>,
}

impl ObservationModel for Line {
    const NAME: &'static str = "line";
    const VERSION: &'static str = "0.1.0";
    const PARAMS_SCHEMA: &'static str = "{}";

    fn create(setup: &ModelSetup) -> Result<Self, PluginError> {
        let slope = setup.observation["params"]["slope"]
            .as_f64()
            .ok_or("`slope` is missing")? as f32;
        let name = setup.observation["params"]["channel"]
            .as_str()
            .unwrap_or("f_d")
            .to_owned();
        Ok(Self {
            slope,
            channels: vec![Channel {
                name,
                kind: ChannelKind::Gaussian,
            }],
        })
    }

    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn moments(
        &self,
        transitions: Transitions<'_>,
        mean: &mut [f32],
        sigma: &mut [f32],
    ) -> Result<Support, PluginError> {
        for (target, state) in mean.iter_mut().zip(transitions.after) {
            assert!(*state >= 0.0, "state {state} is negative");
            *target = self.slope * state;
        }
        sigma.fill(2.0);
        Ok(Support::Given)
    }
}

fn joint() -> JointSetup {
    JointSetup {
        r#type: JointType::Abstract,
        lower: 0.0,
        upper: 10.0,
        integer: false,
        radius_m: None,
        opening_direction: None,
        hinge_direction: None,
        up_direction: None,
        motion_threshold_m: None,
    }
}

fn actions() -> Vec<ActionSetup> {
    let action = |name: &str, stop, displacement| ActionSetup {
        name: name.to_owned(),
        stop,
        mode: Mode::Safe,
        displacement,
        observations: 1,
    };
    vec![action("stop", true, 0.0), action("right", false, 1.0)]
}

fn model_setup(params: serde_json::Value) -> Vec<u8> {
    let setup = ModelSetup {
        joint: joint(),
        actions: actions(),
        control: None,
        belief: BeliefSetup {
            particles: 3,
            spacing: 1.0,
        },
        observation: json!({ "model": "line", "params": params }),
        seed: 1,
    };
    serde_json::to_vec(&setup).unwrap()
}

/// Calls with an error buffer; returns the status and the text in it.
fn call(function: impl FnOnce(*mut c_char, usize) -> i32) -> (i32, String) {
    let mut text = [0 as c_char; 256];
    let status = function(text.as_mut_ptr(), text.len());
    // SAFETY: the plugin closes the text; the buffer started as zeros.
    let text = unsafe { CStr::from_ptr(text.as_ptr()) };
    (status, text.to_str().unwrap().to_owned())
}

#[test]
fn a_model_answers_through_its_table() {
    let plugin = observation_model_table::<Line>();
    assert!(plugin.driver.is_null());
    // SAFETY: the table is static; each call below keeps the rules of pubs_plugin.h.
    unsafe {
        let table = &*plugin.observation_model;
        let create = |json: &[u8]| {
            let mut instance: *mut c_void = null_mut();
            let (status, text) =
                call(|e, n| table.create.unwrap()(json.as_ptr(), json.len(), &mut instance, e, n));
            (status, text, instance)
        };
        let long = "a channel name of more than thirty-one bytes";
        for (setup, expected) in [
            (b"not JSON".to_vec(), "the setup is not valid"),
            (model_setup(json!({})), "`slope` is missing"),
            (
                model_setup(json!({ "slope": 1.0, "channel": long })),
                "longer than 31 bytes",
            ),
        ] {
            let (status, text, instance) = create(&setup);
            assert!(
                status == STATUS_ERROR && text.contains(expected),
                "{status} {text}, want {expected}"
            );
            assert!(instance.is_null());
        }
        assert_eq!(create(&[]).0, STATUS_ERROR);
        let (status, text, model) = create(&model_setup(json!({ "slope": 3.0 })));
        assert_eq!((status, text.as_str()), (STATUS_OK, ""));

        let mut entry = ChannelEntry {
            name: [1; 32],
            kind: 9,
        };
        let mut count = 0;
        let (status, _) =
            call(|e, n| table.channels.unwrap()(model, &mut entry, 1, &mut count, e, n));
        assert_eq!((status, count, entry.kind), (STATUS_OK, 1, 0));
        assert_eq!(CStr::from_ptr(entry.name.as_ptr()).to_str().unwrap(), "f_d");

        let after = [1.0_f32, 2.0, -1.0];
        let (mut mean, mut sigma) = ([0.0_f32; 3], [0.0_f32; 3]);
        let moments = table.moments.unwrap();
        let mut ask = |action, count, before: *const f32| {
            call(|e, n| {
                moments(
                    model,
                    action,
                    before,
                    after.as_ptr(),
                    count,
                    mean.as_mut_ptr(),
                    sigma.as_mut_ptr(),
                    e,
                    n,
                )
            })
        };
        assert_eq!(ask(1, 2, after.as_ptr()).0, STATUS_OK);
        assert_eq!(ask(1, 0, null()).0, STATUS_OK);
        assert_eq!(
            ask(1, 3, after.as_ptr()),
            (STATUS_PANIC, "state -1 is negative".to_owned())
        );
        assert_eq!(
            ask(2, 2, after.as_ptr()),
            (STATUS_ERROR, "there is no action 2, only 0 to 1".to_owned())
        );
        assert_eq!(
            ask(1, 2, null()),
            (
                STATUS_ERROR,
                "`before` is null, 2 values are wanted".to_owned()
            )
        );
        assert_eq!(ask(1, usize::MAX, null()).0, STATUS_ERROR);
        assert_eq!((mean, sigma), ([3.0, 6.0, 0.0], [2.0, 2.0, 0.0]));

        let grid = table.moments_grid.unwrap();
        let (status, _) = call(|e, n| {
            grid(
                model,
                1,
                0.0,
                1.0,
                1.0,
                3,
                mean.as_mut_ptr(),
                sigma.as_mut_ptr(),
                e,
                n,
            )
        });
        assert_eq!(status, STATUS_ABSENT);
        assert_eq!(
            call(|e, n| table.destroy.unwrap()(model, e, n)).0,
            STATUS_OK
        );
        assert_eq!(
            call(|e, n| table.destroy.unwrap()(null_mut(), e, n)).0,
            STATUS_OK
        );
    }
}

struct Pen {
    reading: Reading,
}

impl Driver for Pen {
    const NAME: &'static str = "pen";
    const VERSION: &'static str = "0.1.0";
    const PARAMS_SCHEMA: &'static str = "{}";

    fn open(setup: &DriverSetup) -> Result<Self, PluginError> {
        let reading = Reading {
            time_ns: setup.seed,
            status: DriverStatus::Fault,
            ..Reading::default()
        };
        Ok(Self { reading })
    }
    fn sensor(&self) -> &str {
        "pen-sensor"
    }
    fn read(&mut self) -> Result<Reading, PluginError> {
        Ok(self.reading)
    }
    fn command(&mut self, twist: Twist, expires_ns: u64) -> Result<(), PluginError> {
        self.reading.position_m = twist.linear_m_s;
        self.reading.time_ns = expires_ns;
        Ok(())
    }
    fn tare(&mut self) -> Result<(), PluginError> {
        Err("the baseline is not quiet".into())
    }
    fn stop(&mut self) -> Result<(), PluginError> {
        panic!("no brake")
    }
    fn diagnose(setup: &DriverSetup) -> Result<Option<Vec<DriverCheck>>, PluginError> {
        if setup.seed == 0 {
            return Ok(None);
        }
        let check = DriverCheck {
            name: "ink".to_owned(),
            state: CheckState::Fault,
            found: format!("{} drops — dry", setup.seed),
            cure: "fill it".to_owned(),
        };
        Ok(Some(vec![check]))
    }
}

/// Keeps the text and counts the calls.
unsafe extern "C" fn keep(context: *mut c_void, text: *const u8, length: usize) {
    // SAFETY: the test below passes its own vector, and a table's text has the length it tells.
    unsafe {
        let kept = &mut *context.cast::<Vec<String>>();
        let text = std::slice::from_raw_parts(text, length);
        kept.push(std::str::from_utf8(text).unwrap().to_owned());
    }
}

fn pen_setup(seed: u64) -> DriverSetup {
    let control = ControlSetup {
        rate_hz: 100.0,
        safe_speed_m_s: 0.05,
        high_speed_m_s: 0.15,
        force_threshold_n: 15.0,
        force_limit_n: 60.0,
        acceleration_m_s2: 1.0,
        stop_deceleration_m_s2: 5.0,
        contact_stiffness_n_per_m: 5000.0,
    };
    DriverSetup {
        joint: joint(),
        actions: actions(),
        control,
        driver: json!({}),
        seed,
    }
}

#[test]
fn a_diagnosis_crosses_as_json() {
    let diagnose = |json: &[u8], sink: Option<TextSink>| {
        let mut kept: Vec<String> = Vec::new();
        // SAFETY: the table is static; the arguments keep the rules of pubs_plugin.h.
        let (status, text) = unsafe {
            let table = &*driver_table::<Pen>().driver;
            let context = (&raw mut kept).cast::<c_void>();
            call(|e, n| table.diagnose.unwrap()(json.as_ptr(), json.len(), sink, context, e, n))
        };
        (status, text, kept)
    };
    let json = |seed| serde_json::to_vec(&pen_setup(seed)).unwrap();
    let found = r#"[{"name":"ink","state":"fault","found":"7 drops — dry","cure":"fill it"}]"#;
    assert_eq!(
        diagnose(&json(7), Some(keep)),
        (STATUS_OK, String::new(), vec![found.to_owned()])
    );
    assert_eq!(
        diagnose(&json(0), Some(keep)),
        (STATUS_ABSENT, String::new(), vec![])
    );
    let (status, text, kept) = diagnose(b"{}", Some(keep));
    assert!(
        status == STATUS_ERROR && text.contains("the setup is not valid") && kept.is_empty(),
        "{status} `{text}` {kept:?}"
    );
    assert_eq!(diagnose(&json(7), None).0, STATUS_ERROR, "a null sink");
}

#[test]
fn a_driver_answers_through_its_table() {
    let setup = pen_setup(42);
    let json = serde_json::to_vec(&setup).unwrap();
    // SAFETY: the table is static; each call below keeps the rules of pubs_plugin.h.
    unsafe {
        let table = &*driver_table::<Pen>().driver;
        assert!(
            table.advance_to.is_none(),
            "a driver in real time has no virtual time"
        );
        let mut pen: *mut c_void = null_mut();
        let (status, text) =
            call(|e, n| table.open.unwrap()(json.as_ptr(), json.len(), &mut pen, e, n));
        assert_eq!((status, text.as_str()), (STATUS_OK, ""));

        let mut name = [1 as c_char; 4];
        assert_eq!(
            call(|e, n| table.sensor.unwrap()(pen, name.as_mut_ptr(), 4, e, n)).0,
            STATUS_OK
        );
        assert_eq!(CStr::from_ptr(name.as_ptr()).to_str().unwrap(), "pen");

        let twist = Twist {
            linear_m_s: [1.0, 2.0, 3.0],
            angular_rad_s: [0.0; 3],
        };
        assert_eq!(
            call(|e, n| table.command.unwrap()(pen, &twist, 77, e, n)).0,
            STATUS_OK
        );
        assert_eq!(
            call(|e, n| table.command.unwrap()(pen, null(), 77, e, n)).0,
            STATUS_ERROR
        );
        let mut reading = RawReading::default();
        assert_eq!(
            call(|e, n| table.read.unwrap()(pen, &mut reading, e, n)).0,
            STATUS_OK
        );
        assert_eq!(
            (reading.time_ns, reading.position_m, reading.status),
            (77, [1.0, 2.0, 3.0], 2)
        );

        let tare = call(|e, n| table.tare.unwrap()(pen, e, n));
        assert_eq!(tare, (STATUS_ERROR, "the baseline is not quiet".to_owned()));
        assert_eq!(
            call(|e, n| table.stop.unwrap()(pen, e, n)),
            (STATUS_PANIC, "no brake".to_owned())
        );
        let mut truth = 5.0;
        assert_eq!(
            call(|e, n| table.truth.unwrap()(pen, &mut truth, e, n)).0,
            STATUS_ABSENT
        );
        assert_eq!(call(|e, n| table.close.unwrap()(pen, e, n)).0, STATUS_OK);
    }
}
