#!/bin/sh
# advice.sh -- what the warning of noise advises follows from the layer that has the noise, and from the way in which
# frames get their indirect light. Seen to fail: frames whose only noise was that of edges were advised INDIRECT=records.
bad() { echo "advice: $*" >&2; exit 1; }
while IFS='|' read -r layer ways says says_not; do
  said=$(sh pipelines/progress.sh advice "$layer" "; indirect light by $ways")
  case $said in *"$says"*) ;; *) bad "$layer by $ways: $said";; esac
  case $says_not,$said in ,*) ;; "$says_not,"*"$says_not"*) bad "$layer by $ways: $said";; esac
done << 'END'
emission|camera paths|smaller ERROR|INDIRECT
emission|records|smaller ERROR|PHOTONS
direct|camera paths|smaller ERROR|INDIRECT
direct|gathering|smaller ERROR|PHOTONS
specular|records|smaller ERROR|PHOTONS
caustic|camera paths|INDIRECT=gather|PHOTONS
caustic|records|PHOTONS|ERROR
indirect|camera paths|INDIRECT=records|PHOTONS
indirect|gathering|PHOTONS|INDIRECT
indirect|records|PHOTONS|ERROR
indirect|light textures|PHOTONS|INDIRECT
volume|records|PHOTONS|ERROR
volume|camera paths|smaller ERROR|PHOTONS
END
exit 0
