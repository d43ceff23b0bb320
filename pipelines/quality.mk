# quality.mk -- options by which speed is bought, for QUALITY=draft and final; `TOOL --help` says what they are without. Each may be given to make.
ifeq ($(QUALITY),draft)
PHOTONS = 100k#          paths of light started per photon map
POINTS  = --point-count 10k --light-samples 2
CACHE   = --rays $(or $(plan_rays),$(RAYS)) --error-bound 0.3
PIXELS  = --spp 2 --pixel-error $(ERROR) --learn-lights
RAYS    = 150#           of a record at most; plan_rays is what a pilot finds enough
ERROR   = 0.05
MOVING  = anew#          of so little light reading what stands costs what it saves
else
PHOTONS = 700k
CACHE   = --rays $(or $(plan_rays),$(RAYS))
PIXELS  = --spp 4 --pixel-error $(ERROR) --learn-lights
RAYS    = 500
ERROR   = 0.016
endif
