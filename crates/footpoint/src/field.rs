//! Normal fields: which normal n(x) a frame has (SPEC § 3).

/// The normal field n(x) (SPEC § 3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum NormalField {
    /// Direction of smallest weighted covariance about x (eqs. 5 and 6). Unsigned. Beyond a third of the support
    /// from the surface it turns sideways and is no normal field any more.
    Covariance,
    /// The same about the weighted average a(x). Unsigned; stays right farther out.
    #[default]
    CentredCovariance,
    /// Weighted average of the samples' normals (eq. 7). Signed; needs normals of consistent sign.
    AveragedNormals,
    /// Main axis of the samples' normals, for normals of unknown sign. Unsigned.
    AveragedAxes,
}

impl NormalField {
    /// Whether the samples must carry normals.
    pub fn needs_normals(self) -> bool {
        matches!(self, Self::AveragedNormals | Self::AveragedAxes)
    }
}

impl std::fmt::Display for NormalField {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Covariance => "covariance",
            Self::CentredCovariance => "centred covariance",
            Self::AveragedNormals => "averaged normals",
            Self::AveragedAxes => "averaged axes",
        })
    }
}
