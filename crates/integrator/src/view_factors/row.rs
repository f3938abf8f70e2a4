/// How many rays of a patch hit one target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Entry {
    /// The target: a patch, or one of the columns after the last patch.
    pub(super) column: u32,
    /// Hits in all passes.
    pub(super) hits: u64,
    /// The sum over passes of the squared hits.
    pub(super) squares: u64,
}

/// The entries of a row with any hits, by ascending column.
///
/// Numbers take seven bits to a byte, columns as the distance from the one before: an entry of few hits takes three
/// or four bytes instead of 24. A street of 22,000 facets has more than 1e8 entries.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Row(Vec<u8>);

impl Row {
    /// An entry to the right of all others; `next` is one past the column of the last one.
    pub(super) fn push(&mut self, next: &mut u32, entry: Entry) {
        let Entry { column, hits, squares } = entry;
        for mut number in [u64::from(column - *next), hits, squares] {
            while number >= 0x80 {
                self.0.push(number as u8 | 0x80);
                number >>= 7;
            }
            self.0.push(number as u8);
        }
        *next = column + 1;
    }

    pub(super) fn entries(&self) -> Entries<'_> {
        Entries { bytes: &self.0, next: 0 }
    }

    /// The sums of both.
    pub(super) fn merged(&self, other: &Self) -> Self {
        pairs(self, other)
            .map(|(column, [a, b])| Entry { column, hits: a.hits + b.hits, squares: a.squares + b.squares })
            .collect()
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.0
    }

    /// The row of these bytes; `None` if no row has them.
    pub(super) fn of_bytes(bytes: &[u8]) -> Option<Self> {
        let row: Self = Entries { bytes, next: 0 }.collect();
        (row.0 == bytes).then_some(row)
    }
}

impl FromIterator<Entry> for Row {
    fn from_iter<I: IntoIterator<Item = Entry>>(entries: I) -> Self {
        let (mut row, mut next) = (Self::default(), 0);
        entries.into_iter().for_each(|entry| row.push(&mut next, entry));
        row
    }
}

/// The entries of a row, up to the first that cannot be read.
#[derive(Clone, Debug)]
pub(super) struct Entries<'a> {
    bytes: &'a [u8],
    next: u32,
}

impl Entries<'_> {
    fn number(&mut self) -> Option<u64> {
        let mut number = 0;
        for shift in (0..63).step_by(7) {
            let (&byte, rest) = self.bytes.split_first()?;
            self.bytes = rest;
            number |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Some(number);
            }
        }
        None
    }
}

impl Iterator for Entries<'_> {
    type Item = Entry;

    fn next(&mut self) -> Option<Entry> {
        let column = self.next.checked_add(u32::try_from(self.number()?).ok()?)?;
        self.next = column.checked_add(1)?;
        Some(Entry { column, hits: self.number()?, squares: self.number()? })
    }
}

/// The columns in which either row has an entry, with those of both; one without hits for a row that has none.
pub(super) fn pairs<'a>(a: &'a Row, b: &'a Row) -> impl Iterator<Item = (u32, [Entry; 2])> + 'a {
    let (mut a, mut b) = (a.entries().peekable(), b.entries().peekable());
    std::iter::from_fn(move || {
        let column = a.peek().into_iter().chain(b.peek()).map(|entry| entry.column).min()?;
        let entry = |row: &mut std::iter::Peekable<Entries<'_>>| {
            row.next_if(|entry| entry.column == column).unwrap_or(Entry { column, hits: 0, squares: 0 })
        };
        Some((column, [entry(&mut a), entry(&mut b)]))
    })
}
