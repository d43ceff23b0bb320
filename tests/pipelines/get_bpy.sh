#!/bin/sh
# get_bpy.sh -- Blender as a Python module (PyPI) into build/peers/bpy, for from_blender.sh. Gives up after 150 s, or where there
# is no network or no Python that a release of bpy is made for. A gigabyte.
home=build/peers/bpy
[ -x $home/bin/python ] && $home/bin/python -c 'import bpy' 2> /dev/null && exit
for choice in python3.11:5.0.1 python3:5.0.1 python3.13:5.3.0; do
  python=${choice%:*}
  wanted=3.11
  [ "${choice#*:}" = 5.3.0 ] && wanted=3.13
  [ "$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])' 2> /dev/null)" = $wanted ] || continue
  rm -rf $home
  "$python" -m venv $home > /dev/null 2>&1 && timeout 150 $home/bin/pip install -q "bpy==${choice#*:}" numpy > /dev/null 2>&1 &&
    $home/bin/python -c 'import bpy' > /dev/null 2>&1 && exit
done
rm -rf $home
echo 'get_bpy.sh: no Blender as a Python module; its test is skipped' >&2
exit 1
