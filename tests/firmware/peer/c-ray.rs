//! As plain C draws it.
#![no_std]
#![no_main]

whitted_firmware::peer!(whitted_firmware::scenes::layouts::CRay);
