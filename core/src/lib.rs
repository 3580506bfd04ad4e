//! A fixed-function ray caster for small machines.
#![no_std]
