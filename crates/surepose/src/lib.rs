//! Drive a differential robot to a pose, and be sure.
#![no_std]
