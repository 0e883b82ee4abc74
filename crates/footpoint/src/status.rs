//! Why a point has no answer.

/// What became of one point (numbers are stable: they are written to binary files).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u8)]
#[non_exhaustive]
pub enum Status {
    /// The answer exists and is exact to the stated accuracy.
    #[default]
    Ok = 0,
    /// No sample is near enough: the point, or an iterate, lies outside the domain B (eq. 1).
    Outside = 1,
    /// The frame is not determined: too few, coincident or collinear samples, or a gap below the accepted one.
    Degenerate = 2,
    /// The weighted average lies too far aside: the zero of f is beyond the rim of the surface.
    Boundary = 3,
    /// The gradient vanishes or disagrees with the frame normal: a medial point, or a false zero of f.
    Singular = 4,
    /// The iteration used up its evaluations.
    NotConverged = 5,
    /// The point has a coordinate that is not finite, or one too large to be told apart within a support.
    Invalid = 6,
}

impl Status {
    /// Every status, in the order of its number.
    pub const ALL: [Self; 7] = [
        Self::Ok,
        Self::Outside,
        Self::Degenerate,
        Self::Boundary,
        Self::Singular,
        Self::NotConverged,
        Self::Invalid,
    ];

    /// The name used in text files and reports: `ok`, `outside`, … `not_converged`, `invalid`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Outside => "outside",
            Self::Degenerate => "degenerate",
            Self::Boundary => "boundary",
            Self::Singular => "singular",
            Self::NotConverged => "not_converged",
            Self::Invalid => "invalid",
        }
    }

    /// Whether the point has its answer.
    pub fn is_ok(self) -> bool {
        self == Self::Ok
    }

    pub(crate) fn from_number(number: u8) -> Self {
        Self::ALL.get(usize::from(number)).copied().unwrap_or(Self::Invalid)
    }
}

impl std::fmt::Display for Status {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_promised() {
        for (number, status) in Status::ALL.into_iter().enumerate() {
            assert_eq!(status as usize, number);
            assert_eq!(Status::from_number(number as u8), status);
        }
    }
}
