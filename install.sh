#!/bin/sh
# Installs a release of Grouser on Linux, without Rust and without root:
#
#   install.sh [--prefix FOLDER] [--version X.Y.Z]   command, page, node, man pages, completions, C library, examples
#   install.sh --remove [--prefix FOLDER]            removes what it installed
#
# FOLDER is ~/.local by default. GROUSER_RELEASES is the address, file:// address or folder of a release's files and replaces
# the project's own. All checks come before the first file is placed; a failure leaves the folder as it was.
set -eu

repository=https://github.com/grouser/grouser
list=share/grouser/installed-files

fail() { # message hint
  printf 'error: %s\n  hint: %s\n' "$1" "$2" >&2
  exit 1
}
usage() {
  sed -n '2,/^set/s/^# \{0,1\}//p' "$0" 2>/dev/null || true
}

main() {
  prefix="${HOME:-}/.local" version='' remove=''
  while [ $# -gt 0 ]; do
    case "$1" in
      --prefix | --version)
        [ $# -gt 1 ] || fail "$1 needs a value" "$1 VALUE"
        if [ "$1" = --prefix ]; then prefix="$2"; else version="${2#v}"; fi
        shift
        ;;
      --remove) remove=yes ;;
      --help | -h)
        usage
        return
        ;;
      *) fail "unknown argument $1" "the arguments are --prefix FOLDER, --version X.Y.Z, --remove" ;;
    esac
    shift
  done
  case "$prefix" in
    '' | /.local) fail "no folder to install in: HOME is not set" "--prefix FOLDER" ;;
    /*) ;;
    *) prefix="$PWD/$prefix" ;;
  esac
  if [ "$remove" ]; then remove_files; else install_release; fi
}

remove_files() {
  [ -s "$prefix/$list" ] || fail "no installation in $prefix" "--prefix is the folder of the installation"
  owned="$(cat "$prefix/$list")"
  for file in $owned; do
    rm -f "$prefix/$file"
  done
  for file in $owned; do
    folder="${file%/*}"
    # empty folders only, from below
    while (cd "$prefix" && rmdir "$folder" 2>/dev/null) && [ "$folder" != "${folder%/*}" ]; do folder="${folder%/*}"; done
  done
  echo "removed grouser from $prefix"
}

fetch() { # name target
  case "$releases" in
    *://*)
      if command -v curl >/dev/null; then
        curl --fail --silent --show-error --location --output "$2" "$releases/$1"
      elif command -v wget >/dev/null; then
        wget -q -O "$2" "$releases/$1"
      else
        fail "neither curl nor wget is installed" "install one of them, or set GROUSER_RELEASES to a folder with the files"
      fi
      ;;
    *) cp "$releases/$1" "$2" ;;
  esac || fail "cannot fetch $releases/$1" "check the network and the version; GROUSER_RELEASES may be a folder with the files"
}

open_folder() {
  if ! mkdir -p "$1" 2>/dev/null || [ ! -w "$1" ]; then
    fail "cannot write to $1" "choose another folder with --prefix"
  fi
}

install_release() {
  [ "$(uname -s)" = Linux ] || fail "releases are for Linux, this is $(uname -s)" "cargo install --git $repository grouser"
  case "$(uname -m)" in
    x86_64 | amd64) machine=x86_64 ;;
    aarch64 | arm64) machine=aarch64 ;;
    *) fail "no release for the machine $(uname -m)" "cargo install --git $repository grouser" ;;
  esac
  for tool in tar gzip sha256sum; do
    command -v "$tool" >/dev/null || fail "$tool is not installed" "install it with the system's package manager"
  done
  releases="${GROUSER_RELEASES:-$repository/releases/${version:+download/v$version}}"
  [ "$releases" != "$repository/releases/" ] || releases="$repository/releases/latest/download"
  releases="${releases#file://}"
  releases="${releases%/}"

  open_folder "$prefix"
  # in the same file system, so that each file is placed by one rename
  work="$(mktemp -d "$prefix/.grouser-XXXXXX")"
  trap 'rm -rf "$work"' EXIT
  trap 'exit 130' HUP INT TERM

  fetch SHA256SUMS "$work/sums"
  # `sha256sum` writes the sum, two characters, the name
  sed -n "s/^\([0-9a-f]\{64\}\)..\(grouser-${version:-[0-9][^ ]*}-$machine-unknown-linux-[a-z]*\.tar\.gz\)\$/\1  \2/p" \
    "$work/sums" >"$work/sum"
  [ "$(wc -l <"$work/sum")" -eq 1 ] ||
    fail "$releases/SHA256SUMS lists no archive of ${version:-one version} for $machine" "check --version and GROUSER_RELEASES"
  archive="$(sed 's/^[0-9a-f]*  //' "$work/sum")"
  fetch "$archive" "$work/$archive"
  (cd "$work" && sha256sum -c sum >/dev/null 2>&1) ||
    fail "$archive does not have the SHA-256 of SHA256SUMS: it is damaged or was replaced" "run the script again; nothing was installed"
  (cd "$work" && gzip -dc "$archive" | tar -xf - && rm "$archive")
  tree="$work/${archive%.tar.gz}"
  found="$("$tree/bin/grouser" --version)" || fail "the program of $archive does not run on this machine" "cargo install --git $repository grouser"
  (cd "$tree" && find . -type f | sed 's|^\./||' | LC_ALL=C sort && echo "$list") >"$work/files"

  # what would fail later, and what is not ours
  touch "$work/owned"
  [ ! -f "$prefix/$list" ] || cp "$prefix/$list" "$work/owned"
  while read -r file; do
    if [ -e "$prefix/$file" ] && ! grep -qxF "$file" "$work/owned"; then
      fail "$prefix/$file exists and was not installed by this script" "remove it, or choose another folder with --prefix"
    fi
  done <"$work/files"
  while read -r file; do
    open_folder "$prefix/${file%/*}"
  done <"$work/files"

  mkdir -p "$tree/${list%/*}"
  LC_ALL=C sort -u "$work/files" "$work/owned" >"$tree/$list"
  # the list first: from here on --remove finds every file
  mv -f "$tree/$list" "$prefix/$list"
  while read -r file; do
    [ "$file" = "$list" ] || mv -f "$tree/$file" "$prefix/$file"
  done <"$work/files"
  # files of an older version
  while read -r file; do
    grep -qxF "$file" "$work/files" || rm -f "$prefix/$file"
  done <"$work/owned"
  mv -f "$work/files" "$prefix/$list"

  echo "installed $found in $prefix: $(cd "$prefix/bin" && echo grouser*), manual pages, completions, C library, examples"
  case ":$PATH:" in
    *":$prefix/bin:"*) command=grouser ;;
    *)
      command="$prefix/bin/grouser"
      echo "$prefix/bin is not on the path; for this shell: export PATH=\"$prefix/bin:\$PATH\""
      ;;
  esac
  echo "try it: $command wheel --soil lunar --radius-m 0.125 --width-m 0.15 --load-n 65 --slip 0.25"
  echo "examples: $command init examples -o examples"
  echo "remove it: install.sh --remove --prefix $prefix"
}

# the whole script is read before anything runs, so a truncated download does nothing
main "$@"
