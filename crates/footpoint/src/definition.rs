//! What is computed: the surface's definition, which can be written down and replayed.

use crate::cloud::CloudError;
use crate::field::NormalField;
use crate::lane::Precision;
use crate::polynomial::HIGHEST;
use crate::run::Cancelled;
use crate::status::Status;
use crate::support::{Support, SupportError};
use crate::weight::Weight;

/// Which surface the samples define.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Kind {
    /// f(x) = n(x)·(x − a(x)) (eq. 2) with this normal field.
    #[non_exhaustive]
    PointSet {
        /// The normal field n.
        field: NormalField,
        /// Degree of the polynomial whose value at x stands for the weighted average, 0 to 3 (SPEC § 12): 0 is the paper's surface,
        /// 2 and 3 are without its bias. Above 0 for centred covariance and averaged normals.
        #[cfg_attr(feature = "serde", serde(default))]
        degree: u8,
    },
    /// Levin's surface: where the plane that fits the samples best (eq. 16) passes through x itself. With n = v0(W(x)) of
    /// covariance about x it is f_L(x) = −G/S = 0, G = Σθ(n·d) + ½Σψ(n·d)³ (SPEC § 7). f_L holds a derivative of the
    /// weight: its curvature is continuous from `Poly4` on.
    Levin,
}

impl Default for Kind {
    fn default() -> Self {
        Self::PointSet { field: NormalField::default(), degree: 0 }
    }
}

/// When a zero of f belongs to the surface (SPEC § 8).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Acceptance {
    /// Least n·∇f; below it the point is *singular*. Default 0.3.
    #[cfg_attr(feature = "serde", serde(with = "crate::written"))]
    pub alignment: f64,
    /// Least gap; below it the point is *degenerate*. Default 0.1.
    #[cfg_attr(feature = "serde", serde(with = "crate::written"))]
    pub gap: f64,
    /// Largest |a − x| across n in units of the local support; above it the point is *boundary*. `None` takes the
    /// value that suits weight and field (0.5 for the default definition).
    #[cfg_attr(feature = "serde", serde(with = "crate::written::optional"))]
    pub boundary: Option<f64>,
}

impl Default for Acceptance {
    fn default() -> Self {
        Self { alignment: 0.3, gap: 0.1, boundary: None }
    }
}

impl Acceptance {
    /// Accepts every zero of f at which a frame exists. Its limits are finite, so that every format can hold them.
    pub const EVERY_ZERO: Self = Self { alignment: f64::MIN, gap: 0.0, boundary: Some(f64::MAX) };
}

/// The surface's definition: kind, weight, support rule, domain, acceptance and precision. The default is the
/// recommended one: centred covariance, `Poly3`, automatic uniform support, double precision.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct Definition {
    kind: Kind,
    degree_fallback: bool,
    weight: Weight,
    support: Support,
    domain_ratio: f64,
    acceptance: Acceptance,
    precision: Precision,
}

impl Default for Definition {
    fn default() -> Self {
        Self {
            kind: Kind::default(),
            degree_fallback: false,
            weight: Weight::default(),
            support: Support::default(),
            domain_ratio: 1.0,
            acceptance: Acceptance::default(),
            precision: Precision::default(),
        }
    }
}

impl Definition {
    /// The recommended definition.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes this kind of surface.
    pub fn with_kind(mut self, kind: Kind) -> Self {
        self.kind = kind;
        self
    }

    /// The point set surface with this normal field; its degree stays.
    pub fn with_field(mut self, field: NormalField) -> Self {
        self.kind = Kind::PointSet { field, degree: self.degree() };
        self
    }

    /// The point set surface of this degree, 0 to 3; its normal field stays.
    pub fn with_degree(mut self, degree: u8) -> Self {
        self.kind = Kind::PointSet { field: self.field(), degree };
        self
    }

    /// Whether the next lower degree answers where the samples do not determine the polynomial: where
    /// tr A · tr A⁻¹ exceeds 1e7 (in single precision 2e4) for the normal equations' matrix A, its diagonal scaled to ones. Without
    /// (the default) such points are *degenerate*. `Want::DEGREE` tells which degree answered; f jumps where it changes.
    pub fn with_degree_fallback(mut self, fallback: bool) -> Self {
        self.degree_fallback = fallback;
        self
    }

    /// Takes this weight.
    pub fn with_weight(mut self, weight: Weight) -> Self {
        self.weight = weight;
        self
    }

    /// Takes this rule for the support radii.
    pub fn with_support(mut self, support: Support) -> Self {
        self.support = support;
        self
    }

    /// Radius of the domain's balls (eq. 1) as a share of the support's, above 0 and at most 1 (the default).
    pub fn with_domain_ratio(mut self, ratio: f64) -> Self {
        self.domain_ratio = ratio;
        self
    }

    /// Takes this rule for accepting zeros of f.
    pub fn with_acceptance(mut self, acceptance: Acceptance) -> Self {
        self.acceptance = acceptance;
        self
    }

    /// Computes in these numbers.
    pub fn with_precision(mut self, precision: Precision) -> Self {
        self.precision = precision;
        self
    }

    /// Which surface.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// The normal field; covariance about x is part of Levin's surface.
    pub fn field(&self) -> NormalField {
        match self.kind {
            Kind::PointSet { field, .. } => field,
            Kind::Levin => NormalField::Covariance,
        }
    }

    /// The degree of the polynomial; 0 for Levin's surface.
    pub fn degree(&self) -> u8 {
        match self.kind {
            Kind::PointSet { degree, .. } => degree,
            Kind::Levin => 0,
        }
    }

    /// Whether lower degrees answer where this one is not determined.
    pub fn degree_fallback(&self) -> bool {
        self.degree_fallback
    }

    /// The weight.
    pub fn weight(&self) -> Weight {
        self.weight
    }

    /// The rule for the support radii.
    pub fn support(&self) -> Support {
        self.support
    }

    /// The domain's share of the support.
    pub fn domain_ratio(&self) -> f64 {
        self.domain_ratio
    }

    /// The rule for accepting zeros of f.
    pub fn acceptance(&self) -> Acceptance {
        self.acceptance
    }

    /// The numbers computed in.
    pub fn precision(&self) -> Precision {
        self.precision
    }

    /// The bound b on |a − x|/h that holds in this dimension.
    pub fn boundary_limit<const D: usize>(&self) -> f64 {
        self.acceptance.boundary.unwrap_or_else(|| match self.field() {
            NormalField::Covariance => self.weight.boundary_limit_about_x(D),
            _ => self.weight.boundary_limit(),
        })
    }

    /// The rule of SPEC § 8 for a zero of f at which a frame exists: its gap, n·∇f, and the part of a − x across n with the
    /// support that it is measured in.
    pub(crate) fn verdict<const D: usize>(
        &self,
        gap: f64,
        alignment: f64,
        (across, support): (f64, f64),
    ) -> Status {
        let rule = self.acceptance;
        if gap < rule.gap {
            Status::Degenerate
        } else if alignment < rule.alignment || alignment.is_nan() {
            Status::Singular
        } else if across > self.boundary_limit::<D>() * support {
            Status::Boundary
        } else {
            Status::Ok
        }
    }

    pub(crate) fn check(&self) -> Result<(), DefinitionError> {
        if !(self.domain_ratio > 0.0 && self.domain_ratio <= 1.0) {
            return Err(DefinitionError::DomainRatio(self.domain_ratio));
        }
        let polynomial =
            matches!(self.field(), NormalField::CentredCovariance | NormalField::AveragedNormals);
        match self.degree() {
            0 => {}
            degree if usize::from(degree) > HIGHEST => return Err(DefinitionError::Degree(degree)),
            degree if !polynomial => return Err(DefinitionError::DegreeOfField(degree, self.field())),
            _ => {}
        }
        match self.weight {
            Weight::Gaussian { cut } if !(1e-300..1.0).contains(&cut) => {
                return Err(DefinitionError::Cut(cut));
            }
            _ => {}
        }
        let Acceptance { alignment, gap, boundary } = self.acceptance;
        match [alignment, gap, boundary.unwrap_or(0.0)].into_iter().find(|limit| limit.is_nan()) {
            Some(limit) => Err(DefinitionError::Acceptance(limit)),
            None => Ok(()),
        }
    }
}

/// A definition that makes no sense, or does not suit its cloud.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DefinitionError {
    /// The domain ratio is not above 0 and at most 1.
    #[error("domain ratio {0}: it must be above 0 and at most 1")]
    DomainRatio(f64),
    /// The degree is above 3.
    #[error("degree {0}: it must be 0, 1, 2 or 3")]
    Degree(u8),
    /// Degrees above 0 need a frame that stays right away from the samples.
    #[error("degree {0} with the field of {1}: use centred covariance or averaged normals, or degree 0")]
    DegreeOfField(u8, NormalField),
    /// The Gaussian's cut is not between 0 and 1.
    #[error("Gaussian cut {0}: it must lie between 1e-300 and 1")]
    Cut(f64),
    /// Supports that differ too much for single precision, whose lattice belongs to the largest.
    #[error(
        "support radii from {smallest:e} to {largest:e}: single precision allows a factor of 1000 between them; \
         use double"
    )]
    SingleRange {
        /// Smallest radius.
        smallest: f64,
        /// Largest radius.
        largest: f64,
    },
    /// A limit of the acceptance rule is not a number.
    #[error("a limit of the acceptance rule is {0}: it must be a number")]
    Acceptance(f64),
    /// The normal field averages normals, and no sample has one.
    #[error("the field of {0} needs normals, and no sample has a usable one: use a covariance field")]
    NormalsAbsent(NormalField),
}

/// Why a surface cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A column does not fit its cloud.
    #[error(transparent)]
    Cloud(#[from] CloudError),
    /// The definition makes no sense, or does not suit the cloud.
    #[error(transparent)]
    Definition(#[from] DefinitionError),
    /// No support can be had.
    #[error(transparent)]
    Support(SupportError),
    /// The computation was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl From<SupportError> for Error {
    fn from(error: SupportError) -> Self {
        match error {
            SupportError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            other => Self::Support(other),
        }
    }
}
