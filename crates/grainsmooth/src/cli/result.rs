//! What becomes of a network that a command makes of a file.

use clap::Args;

use super::files::OutputArguments;
use super::pictures::PictureArguments;
use super::run::SharedArguments;

/// What is written and shown, and how.
#[derive(Debug, Args)]
pub struct ResultArguments {
    #[command(flatten)]
    pub outputs: OutputArguments,

    #[command(flatten)]
    pub pictures: PictureArguments,

    #[command(flatten)]
    pub shared: SharedArguments,
}
