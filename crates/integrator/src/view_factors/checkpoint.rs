//! View factors as files, in little-endian numbers: magic, version, passes, rays of a pass, patches, key, the area of
//! each patch, the length of each row, all rows, and a checksum of it all.

use super::row::Row;
use super::{FactorSettings, ViewFactors};
use crate::bytes::{ByteReader, sealed, unsealed};
use crate::error::CHECKPOINT_VERSION;
use crate::{CheckpointError, Ending, Sampler};

const MAGIC: [u8; 8] = *b"GLBLVIEW";

impl ViewFactors {
    /// The view factors as a checkpoint, the same bytes on every machine.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        let numbers = [CHECKPOINT_VERSION, self.passes, self.pass_rays, self.patches()];
        bytes.extend(numbers.into_iter().flat_map(u32::to_le_bytes));
        bytes.extend(self.key.to_le_bytes());
        bytes.extend(self.areas.iter().flat_map(|area| area.to_le_bytes()));
        bytes.extend(self.rows.iter().flat_map(|row| (row.bytes().len() as u64).to_le_bytes()));
        self.rows.iter().for_each(|row| bytes.extend(row.bytes()));
        sealed(0, bytes).0
    }

    /// The view factors that [`ViewFactors::to_bytes`] wrote.
    ///
    /// # Errors
    /// [`CheckpointError`] for any other bytes, without having allocated more memory than a small multiple of their
    /// length.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CheckpointError> {
        let mut numbers = ByteReader(bytes.strip_prefix(&MAGIC).ok_or(CheckpointError::NoCheckpoint)?);
        let version = numbers.u32()?;
        if version != CHECKPOINT_VERSION {
            return Err(CheckpointError::Version(version));
        }
        unsealed(0, bytes)?;
        let (passes, pass_rays, patches) = (numbers.u32()?, numbers.u32()?, numbers.u32()?);
        let key = numbers.u64()?;
        let areas = (0..patches).map(|_| numbers.f64()).collect::<Result<Vec<_>, _>>()?;
        let lengths = (0..patches).map(|_| numbers.u64()).collect::<Result<Vec<_>, _>>()?;
        let mut rest = numbers.0;
        let mut factors = Self { passes, ending: Ending::Open, ..Self::new(areas, pass_rays, key) };
        for (row, length) in factors.rows.iter_mut().zip(lengths) {
            let length = usize::try_from(length).map_err(|_| CheckpointError::Length)?;
            let (bytes, below) = rest.split_at_checked(length).ok_or(CheckpointError::Length)?;
            *row = Row::of_bytes(bytes).ok_or(CheckpointError::Malformed("row"))?;
            rest = below;
        }
        // Only the checksum is left.
        if rest.len() != 8 {
            return Err(CheckpointError::Length);
        }
        factors.check()?;
        Ok(factors)
    }

    /// Refuses what no run writes.
    fn check(&self) -> Result<(), CheckpointError> {
        let is_area = |area: &f64| *area > 0.0 && area.is_finite();
        let is_pass = self.pass_rays.is_power_of_two()
            && self.pass_rays <= Sampler::MAX_PASS
            && self.passes <= FactorSettings::MAX_PASSES;
        if !is_pass || !self.areas.iter().all(is_area) {
            return Err(CheckpointError::Malformed("number of rays or area"));
        }
        for row in &self.rows {
            let mut sum = 0_u64;
            for entry in row.entries() {
                let (hits, squares) = (u128::from(entry.hits), u128::from(entry.squares));
                let is_sum_of_squares = squares >= hits
                    && squares <= hits * u128::from(self.pass_rays)
                    && squares * u128::from(self.passes) >= hits * hits;
                if hits == 0 || !is_sum_of_squares || entry.column > self.patches().saturating_add(1) {
                    return Err(CheckpointError::Malformed("number of hits"));
                }
                sum = sum.saturating_add(entry.hits);
            }
            if sum != self.rays() {
                return Err(CheckpointError::Malformed("sum of hits"));
            }
        }
        Ok(())
    }
}
