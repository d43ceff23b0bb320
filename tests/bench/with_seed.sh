#!/bin/sh
# with_seed.sh SEED COMMAND [ARGUMENT...] -- runs COMMAND, with --seed SEED if it is a tool that draws random numbers.
seed=$1
shift
case $1 in
  */photon-trace | */irradcache-build | */frame-render) exec "$@" --seed "$seed" ;;
esac
exec "$@"
