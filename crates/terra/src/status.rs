//! How a solve for an operating point ended.

/// Declares the statuses: the enum, the list of all, and their names.
macro_rules! statuses {
    ($($(#[$attribute:meta])+ $status:ident = $code:literal, $key:literal;)+) => {
        /// How a solve for an operating point ended; the number is the code for foreign interfaces.
        ///
        /// ```
        /// use grouser_terra::SolveStatus;
        ///
        /// // The default of a column that a batch has not written yet is no success.
        /// assert_eq!(SolveStatus::default().key(), "not-converged");
        /// ```
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        #[repr(u8)]
        pub enum SolveStatus {
            $($(#[$attribute])+ $status = $code,)+
        }

        impl SolveStatus {
            /// Every status, in the order of the codes.
            pub const ALL: [Self; [$($code),+].len()] = [$(Self::$status),+];

            /// Its name in files and in JSON.
            #[must_use]
            pub const fn key(self) -> &'static str {
                match self { $(Self::$status => $key,)+ }
            }
        }
    };
}

statuses! {
    /// Computed.
    Solved = 0, "ok";
    /// No sinkage below the hub carries the load.
    NoSolution = 1, "no-solution";
    /// The search for the sinkage ended without its result.
    #[default]
    NotConverged = 2, "not-converged";
    /// The point is no operating point: [`WheelOnSoil`](crate::WheelOnSoil) names the reason.
    BadInput = 3, "bad-input";
}

impl SolveStatus {
    /// The code of this status.
    ///
    /// ```
    /// # use grouser_terra::SolveStatus;
    /// assert_eq!(SolveStatus::Solved.code(), 0);
    /// assert_eq!(SolveStatus::BadInput.code(), 3);
    /// ```
    #[must_use]
    pub const fn code(self) -> u8 {
        self as u8
    }
}
