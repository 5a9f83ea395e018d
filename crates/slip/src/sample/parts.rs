//! Measurements as plain numbers, and the macro that declares them.

/// A measurement without its names: what interfaces pass on that do not know the Rust types (C, Python).
///
/// The fields of its kind, in their order: an index and a counter, if it has one, and numbers; a vector takes three.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeasurementParts {
    /// The index of its wheel or joint.
    pub index: usize,
    /// The bits of its counter.
    pub count: u64,
    /// Its numbers; `None` for one that is not measured, and after the last.
    pub numbers: [Option<f64>; MAX_NUMBERS],
}

/// The numbers of the largest kind: an inertial unit's.
const MAX_NUMBERS: usize = 6;

/// A field of a kind of measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeasurementField {
    /// Its name with its unit, as keywords and columns have it.
    pub key: &'static str,
    /// Its unit; `1` for a pure number, a tick for a counter.
    pub unit: &'static str,
    /// Which part of [`MeasurementParts`] has it.
    pub part: MeasurementPart,
}

/// What a field of a measurement is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeasurementPart {
    /// The index of a joint; that of a wheel is no field.
    Index,
    /// The bits of a counter.
    Count,
    /// A number.
    Number,
    /// A number, 1 for yes and -1 for no.
    YesOrNo,
    /// A number that may not be measured.
    OptionalNumber,
    /// Three numbers: forwards, to the left, up.
    Vector,
}

/// Parts that are written or read one after the other.
pub(super) struct Cursor {
    pub(super) parts: MeasurementParts,
    next: usize,
}

impl Cursor {
    pub(super) const fn new(parts: MeasurementParts) -> Self {
        Self { parts, next: 0 }
    }

    fn number(&mut self) -> Option<&mut Option<f64>> {
        self.next += 1;
        self.parts.numbers.get_mut(self.next - 1)
    }
}

/// The type of a field.
pub(super) trait Field: Sized {
    const PART: MeasurementPart;

    fn write(self, to: &mut Cursor);

    /// `None` where a number is missing.
    fn read(from: &mut Cursor) -> Option<Self>;

    /// Its first number that is NaN or infinite.
    fn bad_number(&self) -> Option<f64> {
        None
    }
}

impl Field for usize {
    const PART: MeasurementPart = MeasurementPart::Index;

    fn write(self, to: &mut Cursor) {
        to.parts.index = self;
    }

    fn read(from: &mut Cursor) -> Option<Self> {
        Some(from.parts.index)
    }
}

impl Field for u64 {
    const PART: MeasurementPart = MeasurementPart::Count;

    fn write(self, to: &mut Cursor) {
        to.parts.count = self;
    }

    fn read(from: &mut Cursor) -> Option<Self> {
        Some(from.parts.count)
    }
}

impl Field for Option<f64> {
    const PART: MeasurementPart = MeasurementPart::OptionalNumber;

    fn write(self, to: &mut Cursor) {
        if let Some(number) = to.number() {
            *number = self;
        }
    }

    fn read(from: &mut Cursor) -> Option<Self> {
        from.number().copied()
    }

    fn bad_number(&self) -> Option<f64> {
        self.filter(|number| !number.is_finite())
    }
}

impl Field for f64 {
    const PART: MeasurementPart = MeasurementPart::Number;

    fn write(self, to: &mut Cursor) {
        Some(self).write(to);
    }

    fn read(from: &mut Cursor) -> Option<Self> {
        Option::read(from)?
    }

    fn bad_number(&self) -> Option<f64> {
        Some(*self).bad_number()
    }
}

impl Field for bool {
    const PART: MeasurementPart = MeasurementPart::YesOrNo;

    fn write(self, to: &mut Cursor) {
        (if self { 1.0 } else { -1.0 }).write(to);
    }

    fn read(from: &mut Cursor) -> Option<Self> {
        f64::read(from).map(|number| number > 0.0)
    }
}

impl Field for [f64; 3] {
    const PART: MeasurementPart = MeasurementPart::Vector;

    fn write(self, to: &mut Cursor) {
        for number in self {
            number.write(to);
        }
    }

    fn read(from: &mut Cursor) -> Option<Self> {
        Some([f64::read(from)?, f64::read(from)?, f64::read(from)?])
    }

    fn bad_number(&self) -> Option<f64> {
        self.iter().find_map(Field::bad_number)
    }
}

/// Declares the measurements: the enum, that of its kinds, and what differs from kind to kind.
macro_rules! measurements {
    ($(
        $(#[doc = $doc:literal])+
        $kind:ident $(of $wheel:ident)? = $name:literal => $taker:ident {
            $($(#[doc = $field_doc:literal])+ $field:ident: $type:ty = $key:literal, $unit:literal;)+
        }
    )+) => {
        /// What a sensor reads.
        ///
        /// The one list of kinds: interfaces read names, units and fields from it ([`MeasurementKind`]).
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Measurement {
            $(
                $(#[doc = $doc])+
                $kind {
                    $(
                        /// The wheel's index in the robot's description.
                        $wheel: usize,
                    )?
                    $($(#[doc = $field_doc])+ $field: $type,)+
                },
            )+
        }

        /// A kind of [`Measurement`]. Decisions by kind are exhaustive, so that a new kind does not build until all are made.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum MeasurementKind {
            $($(#[doc = $doc])+ $kind,)+
        }

        impl MeasurementKind {
            /// Every kind.
            pub const ALL: &[Self] = &[$(Self::$kind),+];

            /// Its name in files and interfaces.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$kind => $name,)+ }
            }

            /// What it is, and what it may come from.
            #[must_use]
            pub const fn words(self) -> &'static str {
                match self { $(Self::$kind => concat!($($doc),+),)+ }
            }

            /// Its fields besides the wheel.
            #[must_use]
            pub const fn fields(self) -> &'static [MeasurementField] {
                match self {
                    $(Self::$kind => &[$(MeasurementField {
                        key: $key,
                        unit: $unit,
                        part: <$type as Field>::PART,
                    }),+],)+
                }
            }

            /// Who takes it.
            pub(crate) const fn taker(self) -> Taker {
                match self { $(Self::$kind => Taker::$taker,)+ }
            }

            /// Is it of one wheel?
            #[must_use]
            pub const fn is_of_a_wheel(self) -> bool {
                match self {
                    $(Self::$kind => {
                        const WHEEL: &[&str] = &[$(stringify!($wheel))?];
                        !WHEEL.is_empty()
                    })+
                }
            }
        }

        impl Measurement {
            /// Its kind.
            #[must_use]
            pub const fn kind(&self) -> MeasurementKind {
                match self { $(Self::$kind { .. } => MeasurementKind::$kind,)+ }
            }

            /// The wheel that it belongs to, as an index in the robot's description.
            #[must_use]
            pub const fn wheel(&self) -> Option<usize> {
                match *self {
                    $($(Self::$kind { $wheel, .. } => Some($wheel),)?)+
                    _ => None,
                }
            }

            /// The same measurement of another wheel; without effect on measurements of the robot.
            ///
            /// ```
            /// use grouser_slip::Measurement;
            ///
            /// let moved = Measurement::WheelAngle { wheel: 0, angle: 1.5 }.with_wheel(3);
            /// assert_eq!(moved.wheel(), Some(3));
            /// ```
            #[must_use]
            pub const fn with_wheel(mut self, index: usize) -> Self {
                match &mut self {
                    $($(Self::$kind { $wheel, .. } => *$wheel = index,)?)+
                    _ => {}
                }
                self
            }

            /// Its plain numbers.
            ///
            /// ```
            /// use grouser_slip::{Measurement, MeasurementKind};
            ///
            /// let parts = Measurement::WheelRate { wheel: 2, rate: 0.5 }.parts();
            /// assert_eq!((parts.index, parts.numbers[0], parts.numbers[1]), (2, Some(0.5), None));
            /// let again = Measurement::from_parts(MeasurementKind::WheelRate, parts);
            /// assert_eq!(again, Some(Measurement::WheelRate { wheel: 2, rate: 0.5 }));
            /// ```
            #[must_use]
            pub fn parts(&self) -> MeasurementParts {
                let mut to = Cursor::new(MeasurementParts::default());
                match *self {
                    $(Self::$kind { $($wheel,)? $($field),+ } => {
                        $($wheel.write(&mut to);)?
                        $($field.write(&mut to);)+
                    })+
                }
                to.parts
            }

            /// The measurement of that kind with these numbers; `None` where one is missing.
            #[must_use]
            pub fn from_parts(kind: MeasurementKind, parts: MeasurementParts) -> Option<Self> {
                let mut from = Cursor::new(parts);
                Some(match kind {
                    $(MeasurementKind::$kind => Self::$kind {
                        $($wheel: Field::read(&mut from)?,)?
                        $($field: Field::read(&mut from)?,)+
                    },)+
                })
            }

            /// Refuses a reading that holds NaN or an infinity; raw ones are checked where they are processed.
            pub(crate) fn check_finite(&self) -> Result<(), Fault> {
                if self.is_raw() {
                    return Ok(());
                }
                match self {
                    $(Self::$kind { $($field,)+ .. } => {
                        $(if let Some(value) = $field.bad_number() {
                            let field = concat!($name, " ", stringify!($field));
                            return Err(Fault::NotFinite { field, value, unit: $unit });
                        })+
                    })+
                }
                Ok(())
            }
        }
    };
}

pub(super) use measurements;
