"""A browser that selenium drives."""

from .browser import Browser


class Driven(Browser):
    """With ``driver`` for what only one of them can be asked."""

    def __init__(self, driver, downloads):
        super().__init__(downloads)
        self.driver = driver

    def navigate(self, url):
        self.driver.get(url)

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def drag(self, places):
        from selenium.webdriver.common.actions.action_builder import ActionBuilder

        actions = ActionBuilder(self.driver, duration=20)
        mouse = actions.pointer_action
        mouse.move_to_location(*places[0]).pointer_down()
        for place in places[1:]:
            mouse.move_to_location(*place)
        mouse.pointer_up()
        actions.perform()

    def keys(self, *keys, held=None):
        from selenium.webdriver import ActionChains

        chain = ActionChains(self.driver)
        if held:
            chain.key_down(held)
        chain.send_keys(*keys)
        if held:
            chain.key_up(held)
        chain.perform()

    def quit(self):
        self.driver.quit()
