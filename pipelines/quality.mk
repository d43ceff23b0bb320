# quality.mk -- options by which speed is bought, for QUALITY=draft and final; `TOOL --help` says what they are without. Each may be given to make.
ifeq ($(QUALITY),draft)
LIGHT   = 100k
PHOTONS = $(or $(plan_paths),$(LIGHT))# paths of light started per photon map; plan_paths are more than LIGHT where a pilot finds that few arrive
POINTS  = --point-count 10k --light-samples 2
CACHE   = --rays $(or $(plan_rays),$(RAYS)) --error-bound 0.3
PIXELS  = --spp 2 --pixel-error $(ERROR) --learn-lights
RAYS    = 150#           of a record at most; plan_rays is what a pilot finds enough
ERROR   = 0.05
MOVING  = anew#          of so little light reading what stands costs what it saves
else
LIGHT   = 700k
PHOTONS = $(or $(plan_paths),$(LIGHT))
CACHE   = --rays $(or $(plan_rays),$(RAYS))
PIXELS  = --spp 4 --pixel-error $(ERROR) --learn-lights
RAYS    = 500
ERROR   = 0.016
endif
