//! Byte examples of the manuals, the rules of the channel, and damage.
