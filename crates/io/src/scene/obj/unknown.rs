use super::source::Statement;
use crate::WarningKind;
use crate::scene::loading::Loading;

/// Statements that the format does not define.
#[derive(Default)]
pub(super) struct UnknownStatements<'a> {
    first: Option<Statement<'a>>,
    count: usize,
}

impl<'a> UnknownStatements<'a> {
    pub(super) fn add(&mut self, statement: &Statement<'a>) {
        self.first.get_or_insert(*statement);
        self.count += 1;
    }

    /// Adds a warning about them at the first one, if there is one.
    pub(super) fn warn(&self, loading: &mut Loading<'_>) {
        if let Some(first) = self.first {
            let kind = WarningKind::UnknownStatements { keyword: first.keyword.into(), count: self.count };
            loading.warn_of(first.at(), kind);
        }
    }
}
