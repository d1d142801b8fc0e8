//! The result of one figure.

/// The result of one figure.
pub(super) struct FigureResult {
    /// Figures of the JSON object.
    pub(super) json: serde_json::Value,
    /// A second entry of the JSON object, under this key.
    pub(super) more: Option<(&'static str, serde_json::Value)>,
    /// Whether it agrees with the paper.
    pub(super) good: bool,
    /// Rows of the table on a terminal.
    pub(super) rows: Vec<[String; 2]>,
}
