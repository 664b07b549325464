//! The guide: what the command and the library do, how good they are and how they work, a page for each subject.
//!
//! | page | what it tells |
//! |---|---|
//! | [`options`] | every option of the command |
//! | [`formats`] | what each format of an output holds |
//! | [`batch`] | many drawings in one go |
//! | [`library`] | tracing from a program of one's own, and where it can step in |
//! | [`hosts`] | Python, Inkscape, and the programs that outputs were opened in |
//! | [`quality`] | how good traces are, and where they fail |
//! | [`speed`] | how long a trace takes, and how much memory |
//! | [`training`] | the networks, and how they are trained again |
//! | [`how_it_works`] | the field, the stages and the order of the modules |
//!
//! The pages hold no items.

#[doc = include_str!("options.md")]
pub mod options {}

#[doc = include_str!("formats.md")]
pub mod formats {}

#[doc = include_str!("batch.md")]
pub mod batch {}

#[doc = include_str!("library.md")]
pub mod library {}

#[doc = include_str!("hosts.md")]
pub mod hosts {}

#[doc = include_str!("quality.md")]
pub mod quality {}

#[doc = include_str!("speed.md")]
pub mod speed {}

#[doc = include_str!("training.md")]
pub mod training {}

#[doc = include_str!("how_it_works.md")]
pub mod how_it_works {}
