//! Numbers in written definitions: infinities as words, because JSON has none and a replay must not lose them.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Written {
    Number(f64),
    Word(String),
}

impl Written {
    fn of(value: f64) -> Self {
        if value.is_finite() { Self::Number(value) } else { Self::Word(value.to_string()) }
    }

    fn value<E: Error>(self) -> Result<f64, E> {
        match self {
            Self::Number(value) => Ok(value),
            Self::Word(word) => word
                .parse()
                .map_err(|_| E::custom(format!("`{word}` is neither a number nor inf, -inf or NaN"))),
        }
    }
}

pub(crate) fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    Written::of(*value).serialize(serializer)
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Written::deserialize(deserializer)?.value()
}

/// The same for a number that may be absent.
pub(crate) mod optional {
    use super::{Deserialize, Deserializer, Serialize, Serializer, Written};

    pub(crate) fn serialize<S: Serializer>(value: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
        value.map(Written::of).serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
        Option::<Written>::deserialize(deserializer)?.map(Written::value).transpose()
    }
}

#[cfg(test)]
mod tests {
    use crate::{Acceptance, Definition, NormalField, Project, Support, Weight};

    #[test]
    fn definitions_read_back_as_they_were_written() {
        let plain = Definition::default();
        let odd = Definition::new()
            .with_acceptance(Acceptance::EVERY_ZERO)
            .with_weight(Weight::Gaussian { cut: 1e-16 })
            .with_field(NormalField::AveragedAxes)
            .with_support(Support::AutoPerSample { effective_neighbours: 20.5 })
            .with_domain_ratio(0.1 + 0.2);
        for definition in [plain, odd] {
            let text = serde_json::to_string(&definition).unwrap();
            assert_eq!(serde_json::from_str::<Definition>(&text).unwrap(), definition, "{text}");
        }
        let how = Project::new().with_tolerance(f64::INFINITY);
        let text = serde_json::to_string(&how).unwrap();
        assert_eq!(serde_json::from_str::<Project>(&text).unwrap(), how, "{text}");
        assert!(serde_json::from_str::<Project>(r#"{"tolerance": "much"}"#).is_err());
    }
}
