use super::{Factor, Reciprocity, Target, ViewFactors};
use std::io::{self, Write};

/// A file format for view factors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FactorFormat {
    /// Comma-separated values: a line `from,to,area,factor,std_err,hits` for each factor, where `area` is that of
    /// `from`, and `to` may be `surroundings` or `back`. Names with commas, quotes or line breaks are quoted (RFC
    /// 4180).
    Csv,
    /// MatrixMarket coordinate format (Boisvert, Pozo and Remington 1996) with a row for each patch. The columns are
    /// the patches, and after them surroundings and back. Comments list names and areas.
    MatrixMarket,
}

/// View factors to be written, as counted or combined by [`Reciprocity`].
#[derive(Clone, Copy, Debug)]
pub struct FactorTable<'a, N> {
    factors: &'a ViewFactors,
    combined: Option<&'a Reciprocity<'a>>,
    name: N,
    least: f64,
}

impl<'a, N: Fn(u32) -> String> FactorTable<'a, N> {
    /// All factors above 0 of patches that are called `name`. A patch should not be called `surroundings` or `back`, as the
    /// other targets are.
    pub fn new(factors: &'a ViewFactors, name: N) -> Self {
        Self { factors, combined: None, name, least: 0.0 }
    }

    /// The factors of `combined` instead, made from the same view factors.
    #[must_use]
    pub fn combined(self, combined: &'a Reciprocity<'a>) -> Self {
        Self { combined: Some(combined), ..self }
    }

    /// Without the factors below `least`, whose rows then add up to less than 1.
    #[must_use]
    pub fn at_least(self, least: f64) -> Self {
        Self { least, ..self }
    }

    /// Writes the table. Numbers are the shortest that give the same `f64`.
    ///
    /// # Errors
    /// Those of `target`.
    pub fn write(&self, format: FactorFormat, target: &mut dyn Write) -> io::Result<()> {
        match format {
            FactorFormat::Csv => self.write_csv(target),
            FactorFormat::MatrixMarket => self.write_matrix_market(target),
        }
    }

    fn write_csv(&self, target: &mut dyn Write) -> io::Result<()> {
        writeln!(target, "from,to,area,factor,std_err,hits")?;
        for patch in 0..self.factors.patches() {
            let (from, area) = (quoted((self.name)(patch)), self.factors.area(patch));
            for (to, Factor { hits, value, std_err }) in self.row(patch) {
                let to = match to {
                    Target::Patch(patch) => quoted((self.name)(patch)),
                    Target::Surroundings => "surroundings".to_owned(),
                    Target::Back => "back".to_owned(),
                };
                writeln!(target, "{from},{to},{area},{value},{std_err},{hits}")?;
            }
        }
        Ok(())
    }

    fn write_matrix_market(&self, target: &mut dyn Write) -> io::Result<()> {
        let patches = self.factors.patches();
        writeln!(target, "%%MatrixMarket matrix coordinate real general")?;
        writeln!(target, "% view factors, {} rays of each patch", self.factors.rays())?;
        writeln!(target, "% column {}: surroundings, column {}: back", patches + 1, patches + 2)?;
        writeln!(target, "% patch, area, name")?;
        for patch in 0..patches {
            let name = (self.name)(patch).replace(['\n', '\r'], " ");
            writeln!(target, "% {} {} {name}", patch + 1, self.factors.area(patch))?;
        }
        let count: usize = (0..patches).map(|patch| self.row(patch).count()).sum();
        writeln!(target, "{patches} {} {count}", patches + 2)?;
        for patch in 0..patches {
            for (to, factor) in self.row(patch) {
                let column = match to {
                    Target::Patch(patch) => patch,
                    Target::Surroundings => patches,
                    Target::Back => patches + 1,
                };
                writeln!(target, "{} {} {}", patch + 1, column + 1, factor.value)?;
            }
        }
        Ok(())
    }

    fn row(&self, patch: u32) -> Box<dyn Iterator<Item = (Target, Factor)> + '_> {
        let least = self.least;
        let large = move |(_, factor): &(Target, Factor)| factor.value >= least;
        match self.combined {
            Some(combined) => Box::new(combined.row(patch).filter(large)),
            None => Box::new(self.factors.row(patch).filter(large)),
        }
    }
}

fn quoted(name: String) -> String {
    if name.contains([',', '"', '\n', '\r']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name }
}
