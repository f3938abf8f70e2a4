/// An element of a sensor as one of those whose samples are stratified together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Member {
    /// Which of all nets.
    pub(crate) net: u64,
    /// Its number in the net, of [`digits`](Member::digits) binary digits. Members of a group have the first half of them
    /// in common, members of a block the sum of both halves, digit by digit without carry.
    pub(crate) number: u32,
    /// The net has `2^digits` members.
    pub(crate) digits: u32,
}

impl Member {
    /// The only one of its net.
    pub(crate) fn alone(net: u64) -> Self {
        Self { net, number: 0, digits: 0 }
    }
}
