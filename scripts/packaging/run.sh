# Pythons of other systems, run on this one: Windows by wine, Linux on arm64 by qemu. Sourced after scripts/setup.
TEST_PACKAGES="$PYTEST iniconfig pluggy packaging pygments sortedcontainers colorama scipy==1.17.1 meshio==5.3.5 rich markdown-it-py mdurl
trimesh==5.2.0 pillow==13.0.0 dask==2026.8.0 distributed==2026.8.0 click cloudpickle fsspec importlib_metadata zipp lazy-importer jinja2 locket
markupsafe msgpack partd psutil pyyaml tblib toolz tornado urllib3 zict"
WINDOWS=$BUILD/windows-python
ARM64=$BUILD/arm64

# windows_python: a Python 3.11 for Windows in build/windows-python, with the packages of the tests.
windows_python() {
  packages wine wine64 file
  [ ! -e "$WINDOWS/python.exe" ] || return 0
  python_sources
  environment packaging $PACKAGING
  step "putting a Python for Windows together"
  "$ENVIRONMENTS/packaging/bin/python" scripts/packaging/windows_python.py "$WINDOWS" numpy==1.26.4 $TEST_PACKAGES
}

# windows_program PROGRAM ARGUMENT...: runs it. Without wine's debugger, which a program that crashes starts: with it comes a desktop that
# keeps standard output open for ever. Wine takes no file as standard output.
windows_program() (
  set -o pipefail
  WINEDLLOVERRIDES=winedbg.exe=d WINEPREFIX=$BUILD/wine WINEDEBUG=-all wine "$@" </dev/null 2>&1 | cat
)

# windows ARGUMENT...: runs that Python.
windows() { PYTHONDONTWRITEBYTECODE=1 PYTHONUTF8=${PYTHONUTF8:-0} windows_program "$WINDOWS/python.exe" "$@"; }

# windows_native ARGUMENT...: runs the C++ tests for it.
windows_native() { windows_program "$BUILD/cross/windows-x64/build/tripatch_tests.exe" "$@"; }

# arm64_python: Debian's Python 3.11 for arm64 in build/arm64, with the packages of the tests that have wheels for it.
arm64_python() {
  packages qemu-user-static
  [ ! -e "$ARM64/usr/bin/python3.11" ] || return 0
  step "getting Debian's Python for arm64"
  local lists=$BUILD/arm64-lists options
  rm -rf "$lists" "$ARM64"; mkdir -p "$lists/lists/partial" "$lists/cache/archives/partial" "$ARM64/packages"
  options=(-qq -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o Dir::State::Lists="$lists/lists" -o Dir::Cache="$lists/cache"
           -o APT::Sandbox::User="$(id -un)")
  apt-get "${options[@]}" update
  (
    cd "$ARM64/packages"
    apt-get "${options[@]}" download python3.11-minimal libpython3.11-minimal libpython3.11-stdlib libc6 libgcc-s1 libstdc++6 libexpat1 \
      zlib1g libssl3 libffi8 libbz2-1.0 liblzma5 libsqlite3-0 libuuid1
    for package in *.deb; do dpkg-deb -x "$package" ..; done
  )
  "$ENVIRONMENTS/test/bin/pip" install -qq --no-deps --no-compile --target "$ARM64/site" --only-binary :all: --implementation cp --python-version 311 \
    --abi cp311 --abi abi3 --abi none --platform manylinux2014_aarch64 --platform manylinux_2_17_aarch64 --platform manylinux_2_28_aarch64 \
    numpy==1.26.4 $TEST_PACKAGES
  rm -rf "$lists" "$ARM64/packages"
}

# arm64 ARGUMENT...: runs it.
arm64() {
  PYTHONPATH=$ARM64/site PYTHONDONTWRITEBYTECODE=1 OPENBLAS_NUM_THREADS=1 qemu-aarch64-static -L "$ARM64" "$ARM64/usr/bin/python3.11" "$@"
}

# arm64_native ARGUMENT...: runs the C++ tests for it.
arm64_native() {
  qemu-aarch64-static -L "$ARM64" "$BUILD/cross/linux-arm64/build/tripatch_tests" "$@"
}

# unpack WHEEL FOLDER: installs a wheel into another system's folder of packages.
unpack() {
  rm -rf "$2"/tripatch "$2"/tripatch-*.dist-info
  python3 -m zipfile -e "$1" "$2"
}
