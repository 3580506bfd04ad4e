#!/usr/bin/env bash
# Everything that whitted needs for bare targets: the tools, the builds, the checks.
#
#   tests/embedded.sh                  install what is missing, then build, run and check all of it
#   tests/embedded.sh long             the checks that take many minutes: large pictures, all of the table,
#                                      every feature
#   tests/embedded.sh setup            only install
#   tests/embedded.sh table            measure, and rewrite tests/charts/firmware.md and .csv
#   tests/embedded.sh compiler         say which compiler the firmware is built with
#   tests/embedded.sh peer TARGET      measure against plain C on one target, say Cortex-M4F
#   tests/embedded.sh build TARGETS .. build tests/firmware for targets with commas between them, or for
#                                      `host` alone; the rest goes to `cargo build`
#
# `build` and `compiler` exit with 77 where no compiler can make the targets.
set -euo pipefail

targets=(
  thumbv6m-none-eabi thumbv7m-none-eabi thumbv7em-none-eabihf thumbv8m.main-none-eabihf
  riscv32imac-unknown-none-elf riscv32imafc-unknown-none-elf wasm32-unknown-unknown
)
root=$(cd "$(dirname "$0")/.." && pwd)
say() { echo "embedded.sh: $*" >&2; }

# What a caller's own cargo left behind would change the flags, the profile or the compiler of the firmware.
unset RUSTFLAGS CARGO_ENCODED_RUSTFLAGS CARGO_BUILD_RUSTFLAGS CARGO_BUILD_TARGET LD_LIBRARY_PATH ${!CARGO_PROFILE_@}

prebuilt() { # COMPILER: has it core for every target?
  local target library
  for target in "${targets[@]}"; do
    library=$("$1" --print target-libdir --target "$target" 2>/dev/null) || return 1
    compgen -G "$library/libcore-*.rlib" >/dev/null || return 1
  done
}

sources() { # COMPILER: has it the sources of core that it was made with?
  [ -e "$("$1" --print sysroot 2>/dev/null)/lib/rustlib/src/rust/library/Cargo.lock" ]
}

# One compiler for all targets, so that the rows of one table can be compared.
pick_compiler() {
  build_core=()
  if prebuilt rustc; then
    compiler=rustc cargo=cargo
  elif sources rustc; then
    compiler=rustc cargo=cargo build_core=(-Zbuild-std=core)
  elif [ -x /usr/bin/rustc ] && [ -x /usr/bin/cargo ] && sources /usr/bin/rustc; then
    compiler=/usr/bin/rustc cargo=/usr/bin/cargo build_core=(-Zbuild-std=core)
  else
    return 1
  fi
}

as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"; else sudo -n "$@"; fi
}

setup() {
  if ! pick_compiler && command -v rustup >/dev/null; then
    say "rustup target add ${targets[*]}"
    timeout 300 rustup target add "${targets[@]}" || say "rustup could not; trying Debian's rust"
  fi
  local missing=() entry
  if ! pick_compiler; then
    if apt-cache show rustc-web >/dev/null 2>&1; then
      missing+=(rustc-web cargo-web rust-web-src)
    else
      missing+=(rustc cargo rust-src)
    fi
    missing+=(lld)
  elif [ ${#build_core[@]} -gt 0 ]; then
    command -v ld.lld >/dev/null && command -v wasm-ld >/dev/null || missing+=(lld)
  fi
  for entry in qemu-system-arm:qemu-system-arm qemu-system-riscv32:qemu-system-misc node:nodejs \
      gcc:gcc arm-none-eabi-gcc:gcc-arm-none-eabi; do
    command -v "${entry%%:*}" >/dev/null || missing+=("${entry##*:}")
  done
  if [ ${#missing[@]} = 0 ]; then
    say "nothing to install"
  elif command -v apt-get >/dev/null && as_root true 2>/dev/null; then
    say "apt-get install ${missing[*]}"
    as_root apt-get update -q >&2
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends "${missing[@]}" >&2
  else
    say "cannot install packages here; please run: sudo apt-get install ${missing[*]}"
    return 77
  fi
}

say_compiler() {
  if ! pick_compiler; then
    say "no compiler for ${targets[*]}"
    say "run 'tests/embedded.sh setup', or 'rustup target add ${targets[*]}'"
    return 77
  fi
  echo "$("$compiler" -V), $([ ${#build_core[@]} = 0 ] && echo "core as shipped" || echo "core from source")"
}

build() { # TARGET[,TARGET..] [arguments of cargo build]
  local target linker arguments=()
  say_compiler >/dev/null
  # The machine at hand has all of it, and is no target to cargo.
  [ "$1" != host ] || build_core=()
  [ ${#build_core[@]} = 0 ] || export RUSTC_BOOTSTRAP=1
  for target in ${1//,/ }; do
    [ "$target" != host ] || continue
    arguments+=(--target "$target")
    # Debian's rustc has no linker of its own for these targets.
    if ! compgen -G "$("$compiler" --print sysroot)/lib/rustlib/*/bin/rust-lld" >/dev/null; then
      linker=ld.lld
      [[ $target == wasm32-* ]] && linker=wasm-ld
      export "CARGO_TARGET_$(tr 'a-z.-' 'A-Z__' <<<"$target")_LINKER=$linker"
    fi
  done
  shift
  export RUSTC=$compiler CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$root/target}/firmware
  # For .cargo/config.toml, which cargo looks for here.
  cd "$root/tests/firmware"
  exec "$cargo" build --release ${arguments[@]+"${arguments[@]}"} ${build_core[@]+"${build_core[@]}"} "$@"
}

case ${1:-all} in
  all)
    setup || [ $? = 77 ]
    say "building with $(say_compiler || true)"
    cd "$root" && exec cargo test -p whitted-tests --test firmware -- --nocapture
    ;;
  long)
    setup || [ $? = 77 ]
    cd "$root" && exec cargo test -p whitted-tests --test firmware -- --nocapture --ignored
    ;;
  setup) setup ;;
  table) cd "$root" && exec cargo run -p whitted-tests --bin firmware -- table ;;
  peer) shift; cd "$root" && exec cargo run -q -p whitted-tests --bin firmware -- peer "$@" ;;
  compiler) say_compiler ;;
  build) shift; build "$@" ;;
  *) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 2 ;;
esac
