//! What the command says of itself: help by topic, completions for shells, manual pages.

use crate::args::{About, Arguments};
use clap::{Command, CommandFactory};

/// Weights, fields and supports in plain words.
const DEFINITION: &str = include_str!("definition.txt");

/// The text that is asked for.
pub(crate) fn text(about: &About) -> String {
    let mut command = Arguments::command();
    command.build();
    match about {
        About::Help { topic: None } => command.render_long_help().to_string(),
        About::Help { topic: Some(topic) } if topic == TOPIC => DEFINITION.to_owned(),
        About::Help { topic: Some(topic) } => {
            of(&mut command, topic, |verb| verb.render_long_help().to_string())
        }
        About::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(*shell, &mut command, "footpoint", &mut script);
            String::from_utf8_lossy(&script).into_owned()
        }
        About::Man { command: None } => manual(command),
        About::Man { command: Some(name) } => of(&mut command, name, |verb| manual(verb.clone())),
    }
}

/// The topic that is no command.
pub(crate) const TOPIC: &str = "definition";

/// Names that help and manual pages go by.
pub(crate) fn names() -> Vec<String> {
    Arguments::command().get_subcommands().map(|verb| verb.get_name().to_owned()).collect()
}

fn of(command: &mut Command, name: &str, say: impl Fn(&mut Command) -> String) -> String {
    command.find_subcommand_mut(name).map(say).unwrap_or_default()
}

fn manual(command: Command) -> String {
    let mut page = Vec::new();
    // Writing to memory does not fail.
    let _ = clap_mangen::Man::new(command).render(&mut page);
    String::from_utf8_lossy(&page).into_owned()
}
