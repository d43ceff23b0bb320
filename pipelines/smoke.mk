# smoke.mk -- taken where scene-plan has found media (plan_media): smoke is put into the frames last. Included by Makefile.example; smoke.md is its page.
# Frames before it are in OUT/clear; what comes through the smoke is dimmed there already.
options_textures = $(TEXTURES) $(shared)
options_smoke    = $(SMOKE) --camera $(CAMERA) $(shared)
$(if $(PLANNED),$(foreach s,textures smoke,$(call note,$s)))

# With UPDATE, in smoke: a map is the one before it, some of its groups shot again (photon-trace --update).
share   = $(if $(plan_media),$(UPDATE))
before  = $(if $(share),$(lit_before_$*:%=$(OUT)/photons/%.photons))
updates = $(before) $(if $(share),$(majorants_$*))
pilots  = $(if $(before),,$(if $(filter fde dip hybrid path,$(STRATEGY)), --pilots 3%))
update  = $(if $(share), --majorants $(majorants_$*)$(pilots))$(before:%= --update % --share $(share) --strategy $(STRATEGY))

# Points: for phase functions with a peak, where rays from the eye end.
smoke_points = $(if $(textured),,$(photons_$*:%=$(OUT)/points/%.irradpoints))
$(pictures): $(OUT)/frames/%.exr: $(OUT)/clear/%.exr $$(photons_$$*:%=$(OUT)/photons/%.photons) $$(smoke_points) $(OUT)/options/smoke $(BIN)/volume-compose
	$(RUN) $(BIN)/volume-compose $(SCENE) --frame $* --base $< --photons $(OUT)/photons/$(photons_$*).photons $(addprefix --points ,$(smoke_points)) \
	  $(options_smoke) -o $@ --stats $(@:.exr=.json)

# SURFACES=textures: indirect light of the surfaces as the smoke has it, photons counted in elements and smoothed, in place of points and cache.
ifneq ($(filter textures,$(SURFACES)),)
$(plan_photons:%=$(OUT)/textures/%.meshirrad): $(OUT)/textures/%.meshirrad: $(OUT)/photons/%.photons $(OUT)/options/textures $(BIN)/st-filter
	$(RUN) $(BIN)/st-filter mesh $(SCENE) --frame $* --photons $< $(options_textures) -o $@ --stats $(@:.meshirrad=.json)
endif
